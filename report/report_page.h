#pragma once

#include <string>
#include <vector>

#include "core/result.h"
#include "diagnosis/explain.h"

namespace hydroscope {

/// The page around `body`: style sheet, theme button, print rules. `title` is plain text. The result is
/// well-formed XML as well as HTML 5, loads nothing from elsewhere and needs no script (the script only adds
/// the theme button).
std::string HtmlPage(const std::string& title, const std::string& body);

inline constexpr double kPageWidth = 920;  ///< px, of plots as wide as the page

/// A plot with its caption, which may be empty; "" without a plot.
std::string Figure(const std::string& svg, const std::string& caption);

/// A verdict in a box, to lead a page; `headline` and `sentences` are HTML.
std::string VerdictSection(Verdict verdict, const std::string& headline,
                           const std::vector<std::string>& sentences);

/// Writes HtmlPage(title, body). Fails if the file cannot be written.
Status WritePage(const std::string& path, const std::string& title, const std::string& body);

}  // namespace hydroscope
