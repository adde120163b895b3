#include "report/svg_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/short_number.h"

namespace hydroscope {
namespace {

constexpr std::string_view kReplacement = "\xEF\xBF\xBD";  // U+FFFD
constexpr std::string_view kMinus = "\xE2\x88\x92";        // U+2212
constexpr std::string_view kThinSpace = "\xE2\x80\xAF";    // U+202F, narrow no-break space

/// Length of the valid UTF-8 sequence at the start of `text`, 0 if there is none.
std::size_t SequenceLength(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char lead = byte(0);
  std::size_t length = 0;
  std::uint32_t code = 0;
  if (lead < 0x80) return 1;
  if (lead >= 0xC2 && lead < 0xE0)
    length = 2, code = lead & 0x1F;
  else if (lead >= 0xE0 && lead < 0xF0)
    length = 3, code = lead & 0x0F;
  else if (lead >= 0xF0 && lead < 0xF5)
    length = 4, code = lead & 0x07;
  if (length == 0 || text.size() < length) return 0;
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xC0) != 0x80) return 0;
    code = code << 6 | (byte(i) & 0x3F);
  }
  const bool overlong = (length == 3 && code < 0x800) || (length == 4 && code < 0x10000);
  const bool not_a_character =
      (code >= 0xD800 && code < 0xE000) || code > 0x10FFFF || code == 0xFFFE || code == 0xFFFF;
  return overlong || not_a_character ? 0 : length;
}

/// Replaces every "_{...}" by before + escaped content + after; the rest is escaped.
std::string WithSubscripts(std::string_view symbol, std::string_view before, std::string_view after) {
  std::string out;
  while (!symbol.empty()) {
    const std::size_t open = symbol.find("_{");
    const std::size_t close = open == symbol.npos ? symbol.npos : symbol.find('}', open);
    if (close == symbol.npos) return out + EscapeText(symbol);
    out += EscapeText(symbol.substr(0, open));
    out += before;
    out += EscapeText(symbol.substr(open + 2, close - open - 2));
    out += after;
    symbol.remove_prefix(close + 1);
  }
  return out;
}

std::string WithRealMinus(std::string text) {
  if (text.starts_with('-')) {
    const bool zero = text.find_first_of("123456789") == text.npos;
    text.replace(0, 1, zero ? std::string_view() : kMinus);
  }
  return text;
}

}  // namespace

std::string EscapeText(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t length = SequenceLength(text.substr(i));
    const char c = text[i];
    if (length == 0)
      out += kReplacement;
    else if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else if (c == '"')
      out += "&quot;";
    else if (c == '\'')
      out += "&#39;";
    else if (length == 1 && (static_cast<unsigned char>(c) < 0x20 || c == 0x7F) && c != '\n' && c != '\t')
      out += kReplacement;
    else
      out += text.substr(i, length);
    i += std::max<std::size_t>(length, 1);
  }
  return out;
}

std::string HtmlSymbol(std::string_view symbol) { return WithSubscripts(symbol, "<sub>", "</sub>"); }

std::string SvgSymbol(std::string_view symbol) {
  // The text after the subscript has to be raised again; a zero-width space carries the way back when none follows.
  return WithSubscripts(symbol, "<tspan dy=\"3\" font-size=\"75%\">",
                        "</tspan><tspan dy=\"-3\">&#8203;</tspan>");
}

std::string PlainSymbol(std::string_view symbol) {
  std::string out;
  for (std::size_t i = 0; i < symbol.size(); ++i) {
    if (symbol.substr(i, 2) == "_{") {
      out += '_';
      ++i;
    } else if (symbol[i] != '}') {
      out += symbol[i];
    }
  }
  return out;
}

std::string FormatFixed(double value, int decimals) {
  if (!std::isfinite(value)) return "–";
  return WithRealMinus(fmt::format("{:.{}f}", value, decimals));
}

int DecimalsFor(double value, double uncertainty) {
  const bool known = std::isfinite(uncertainty) && uncertainty > 0;
  const double scale = known ? uncertainty : std::abs(value);
  if (!std::isfinite(scale) || scale == 0) return known ? 0 : 1;
  const int digits = known ? 2 : 4;
  return std::clamp(digits - 1 - static_cast<int>(std::floor(std::log10(scale * (known ? 1.0049 : 1.0)))), 0,
                    9);
}

std::string FormatWithUncertainty(double value, double uncertainty) {
  const int decimals = DecimalsFor(value, uncertainty);
  if (!std::isfinite(uncertainty) || uncertainty <= 0) return FormatFixed(value, decimals);
  return FormatFixed(value, decimals) + " ± " + FormatFixed(uncertainty, decimals);
}

std::string FormatSigned(double value, int decimals) {
  const std::string text = FormatFixed(value, decimals);
  const bool plain = text.starts_with(kMinus) || text.find_first_of("123456789") == text.npos;
  return plain ? text : "+" + text;
}

std::string FormatCount(std::int64_t count) {
  std::string digits = std::to_string(count < 0 ? -count : count);
  if (digits.size() > 4)
    for (std::size_t i = digits.size() - 3; i > 0 && i<digits.size(); i = i> 3 ? i - 3 : 0)
      digits.insert(i, kThinSpace);
  return (count < 0 ? std::string(kMinus) : std::string()) + digits;
}

std::string FormatShort(double value) {
  if (!std::isfinite(value)) return "–";
  return WithRealMinus(ShortNumber(value, 4));
}

}  // namespace hydroscope
