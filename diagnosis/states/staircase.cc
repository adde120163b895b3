#include "diagnosis/states/staircase.h"

#include <algorithm>

#include "core/contains.h"

namespace hydroscope {
namespace {

bool HoldsEffect(const StateCandidate& set, const std::string& id) { return Contains(set.added, id); }
bool HoldsAll(const StateCandidate& all, const StateCandidate& some) {
  return std::all_of(some.added.begin(), some.added.end(),
                     [&](const std::string& id) { return HoldsEffect(all, id); });
}

}  // namespace

std::vector<std::pair<std::string, double>> StaircaseTo(
    const StateCandidate& found, const std::vector<std::vector<StateCandidate>>& levels) {
  std::vector<std::pair<std::string, double>> steps;
  const StateCandidate* before = nullptr;
  for (const std::vector<StateCandidate>& level : levels) {
    const auto on_the_way = std::find_if(level.begin(), level.end(), [&](const StateCandidate& set) {
      return HoldsAll(found, set) && (before == nullptr || HoldsAll(set, *before));
    });
    if (on_the_way == level.end()) continue;
    std::string added;
    for (const std::string& id : on_the_way->added)
      if (before == nullptr || !HoldsEffect(*before, id)) added += (added.empty() ? "" : " + ") + id;
    steps.emplace_back(before == nullptr ? "" : added, ErrorLeftOut(on_the_way->fit));
    before = &*on_the_way;
  }
  return steps;
}

}  // namespace hydroscope
