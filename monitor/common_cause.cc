#include "monitor/common_cause.h"

#include <algorithm>
#include <map>

namespace hydroscope {
namespace {

using Members = std::vector<CommonCause::Member>;

/// Findings of all axes that match, in order of their changes.
Members Matching(const drift::Rule& rule, std::span<const FindingHistory* const> axes) {
  Members matching;
  for (std::size_t a = 0; a < axes.size(); ++a)
    for (const StandingFinding& finding : axes[a]->findings())
      if (rule.Matches(finding.movements)) matching.push_back({static_cast<int>(a), finding});
  std::ranges::stable_sort(matching,
                           [](const auto& x, const auto& y) { return x.finding.since < y.finding.since; });
  return matching;
}

/// The largest group that stands at `stroke` and began together, one finding of each axis; empty if it is
/// smaller than the rule asks for.
Members TogetherAt(std::int64_t stroke, const drift::Rule& rule, const Members& matching) {
  Members largest;
  for (std::size_t first = 0; first < matching.size(); ++first) {
    Members group;
    for (std::size_t k = first; k < matching.size(); ++k) {
      const StandingFinding& f = matching[k].finding;
      if (f.since - matching[first].finding.since > rule.within) break;
      const bool of_new_axis =
          std::ranges::none_of(group, [&](const auto& member) { return member.axis == matching[k].axis; });
      if (f.StandsAt(stroke) && of_new_axis) group.push_back(matching[k]);
    }
    if (group.size() > largest.size()) largest = std::move(group);
  }
  if (static_cast<int>(largest.size()) < rule.axes) largest.clear();
  return largest;
}

}  // namespace

std::vector<CommonCause> CommonCauses(const drift::Rule& rule, std::span<const FindingHistory* const> axes) {
  const Members matching = Matching(rule, axes);
  std::map<std::int64_t, double> changes;  // stroke at which something begins or ceases to stand -> its time
  for (const auto& [axis, finding] : matching) {
    changes.emplace(finding.from, finding.from_time);
    if (finding.to != StandingFinding::kStillStands) changes.emplace(finding.to, finding.to_time);
  }
  std::vector<CommonCause> causes;
  bool stands = false;
  for (const auto& [stroke, time] : changes) {
    Members members = TogetherAt(stroke, rule, matching);
    if (stands && members.empty()) {
      causes.back().to = stroke;
      causes.back().to_time = time;
    }
    if (!stands && !members.empty()) {
      causes.emplace_back();
      causes.back().from = stroke;
      causes.back().from_time = time;
    }
    stands = !members.empty();
    if (stands) causes.back().members = std::move(members);
  }
  return causes;
}

}  // namespace hydroscope
