#include "report/svg_sheet.h"

#include <fmt/format.h>

#include <algorithm>

#include "report/svg_text.h"

namespace hydroscope {
namespace {

constexpr double kMargin = 10, kLine = 22;  // px

/// A rendered plot placed at height `y` of the sheet.
std::string Placed(const SvgPlot& plot, double y) {
  static const std::string kMark = "class=\"p-plot\"";
  std::string svg = plot.Render();
  svg.insert(svg.find(kMark) + kMark.size(),
             fmt::format(" x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"", kMargin, y, plot.options().width,
                         plot.options().height));
  return svg;
}

}  // namespace

std::string SvgSheet(const std::string& title, const std::string& note, const std::vector<SvgPlot>& plots) {
  std::string body;
  double width = 0, y = kMargin;
  for (const auto& [text, style] :
       {std::pair{title, "font-size:15px;font-weight:600"}, {note, "fill:var(--p-neutral)"}}) {
    if (text.empty()) continue;
    body += fmt::format("<text x=\"{}\" y=\"{}\" style=\"{}\">{}</text>\n", kMargin, y + kLine - 6, style,
                        EscapeText(text));
    y += kLine;
  }
  for (const SvgPlot& plot : plots) {
    body += Placed(plot, y);
    width = std::max(width, plot.options().width);
    y += plot.options().height + kMargin;
  }
  return fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"p-plot\" viewBox=\"0 0 {0} {1}\" width=\"{0}\" height=\"{1}\" "
      "role=\"img\" aria-label=\"{2}\">\n<title>{2}</title>\n<style>{3}svg{{color-scheme:light dark}}</style>\n"
      "<rect width=\"100%\" height=\"100%\" style=\"fill:var(--p-paper)\"/>\n{4}</svg>\n",
      width + 2 * kMargin, y, EscapeText(title), PlotStyleSheet(), body);
}

}  // namespace hydroscope
