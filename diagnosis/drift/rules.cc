#include "diagnosis/drift/rules.h"

#include <algorithm>
#include <cmath>

#include "core/contains.h"

namespace hydroscope::drift {

DriftSize WatchSpec::Sizes(double typical) const {
  const auto absolute = [&](const ChangeSpec& c) {
    return c.relative ? c.value * std::abs(typical) : c.value;
  };
  return {absolute(smallest), absolute(alarm), only_upwards};
}

bool Rule::Matches(const std::map<std::string, int>& moved) const {
  for (const auto& [quantity, movement] : when) {
    const auto found = moved.find(quantity);
    if (found == moved.end()) return false;
    if (movement == Movement::kUp && found->second < 0) return false;
    if (movement == Movement::kDown && found->second > 0) return false;
  }
  return std::all_of(moved.begin(), moved.end(),
                     [&](const auto& m) { return when.contains(m.first) || Contains(may, m.first); });
}

const WatchSpec* RuleBook::Find(const std::string& quantity) const {
  const auto found =
      std::find_if(watches.begin(), watches.end(), [&](const auto& w) { return w.quantity == quantity; });
  return found == watches.end() ? nullptr : &*found;
}

const Rule* RuleBook::Match(const std::map<std::string, int>& moved, int axes) const {
  const Rule* best = nullptr;
  const auto rank = [](const Rule& r) { return std::pair(r.axes, r.when.size()); };
  for (const Rule& rule : rules)
    if (axes >= rule.axes && rule.Matches(moved) && (best == nullptr || rank(rule) > rank(*best)))
      best = &rule;
  return best;
}

}  // namespace hydroscope::drift
