#include "workbench/explain/untested_text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace hydroscope {

std::string UntestedText(const std::vector<std::pair<std::string, std::string>>& why_not,
                         std::string_view counted) {
  std::vector<std::pair<std::string, std::vector<std::string>>> by_reason;
  for (const auto& effect : why_not) {
    const auto& why = effect.second;
    auto same = std::ranges::find_if(by_reason, [&](const auto& group) { return group.first == why; });
    if (same == by_reason.end()) same = by_reason.insert(same, {why, {}});
    same->second.push_back(effect.first);
  }
  std::string text;
  for (const auto& [why, ids] : by_reason)
    text += ids.size() == 1 ? fmt::format("  {:<28} {}\n", ids.front(), why)
                            : fmt::format("  {}\n    {}\n", fmt::join(ids, ", "), why);
  return text.empty() ? text
                      : fmt::format("\nCannot be tested with these {} (which does not mean absent)\n{}",
                                    counted, text);
}

}  // namespace hydroscope
