#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace hydroscope {

/// Text made safe for XML and HTML content and double-quoted attributes: & < > " ' become entities, control
/// characters and bytes that are no UTF-8 become U+FFFD.
std::string EscapeText(std::string_view text);

/// Symbols carry subscripts as "Q_{vn}". The same in HTML (<sub>), in SVG (<tspan>) and as plain text
/// ("Q_vn"). Everything else is escaped (not in plain text, which is for attributes that the caller escapes).
std::string HtmlSymbol(std::string_view symbol);
std::string SvgSymbol(std::string_view symbol);
std::string PlainSymbol(std::string_view symbol);

/// Number with a fixed count of decimals, a real minus sign, and no "-0.0"; "–" if not finite.
std::string FormatFixed(double value, int decimals);

/// Decimals that show `uncertainty` with two significant digits (0...9); four significant digits of `value`
/// if the uncertainty is 0 or not finite.
int DecimalsFor(double value, double uncertainty);

/// "1.412 ± 0.021", both with the decimals of DecimalsFor; only the value if the uncertainty is not finite or
/// 0.
std::string FormatWithUncertainty(double value, double uncertainty);

/// As FormatFixed with an explicit plus sign.
std::string FormatSigned(double value, int decimals);

/// Whole number with thin spaces between groups of three from 10 000 on: "1 234 567".
std::string FormatCount(std::int64_t count);

/// Four significant digits without exponent where that stays short: "1500", "0.01235", "1.2e-7".
std::string FormatShort(double value);

}  // namespace hydroscope
