#include "diagnosis/states/found_sets.h"

#include <algorithm>

namespace hydroscope {

const StateCandidate& FoundSets::Without(const std::string& id) {
  std::vector<std::string> rest = out.final.added;
  rest.erase(std::find(rest.begin(), rest.end(), id));
  const auto known = without.find(rest);
  if (known != without.end()) return known->second;
  StateCandidate fitted = fits->Without(out.final, rest);
  return without.emplace(rest, std::move(fitted)).first->second;
}

}  // namespace hydroscope
