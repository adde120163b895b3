#include "report/unranked_effects.h"

#include <fmt/format.h>

#include "report/svg_text.h"

namespace hydroscope {

std::string UnrankedEffects(const std::vector<std::pair<std::string, std::string>>& effects) {
  if (effects.empty()) return "";
  std::string rows;
  for (const auto& [id, why] : effects)
    rows += fmt::format("<tr><td>{}</td><td>{}</td></tr>", EscapeText(id), EscapeText(why));
  return "<div class=\"sheet ids\"><table><tr><th>Not in the ranking</th><th>Why (which does not mean absent)</th></tr>" +
         rows + "</table></div>\n";
}

}  // namespace hydroscope
