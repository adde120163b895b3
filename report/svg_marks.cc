#include "report/svg_marks.h"

#include <fmt/format.h>

#include <algorithm>

#include "report/svg_text.h"

namespace hydroscope {

const char* InkClass(Ink ink) {
  switch (ink) {
    case Ink::kBlue:
      return "p-blue";
    case Ink::kVermillion:
      return "p-vermillion";
    case Ink::kGreen:
      return "p-green";
    case Ink::kOrange:
      return "p-orange";
    case Ink::kPurple:
      return "p-purple";
    case Ink::kSky:
      return "p-sky";
    case Ink::kNeutral:
      return "p-neutral";
  }
  return "p-neutral";
}

std::string DashAttribute(Dash dash) {
  switch (dash) {
    case Dash::kSolid:
      return "";
    case Dash::kDashed:
      return " stroke-dasharray=\"7 4\"";
    case Dash::kDotted:
      return " stroke-dasharray=\"1.5 3.5\"";
    case Dash::kDashDot:
      return " stroke-dasharray=\"8 3 1.5 3\"";
  }
  return "";
}

std::string Px(double value) {
  std::string text = fmt::format("{:.1f}", value);
  if (text.ends_with(".0")) text.resize(text.size() - 2);
  return text == "-0" ? "0" : text;
}

double TextWidth(const std::string& text) {
  const std::string plain = PlainSymbol(text);
  return 6.9 * static_cast<double>(std::ranges::count_if(plain, [](char c) { return (c & 0xC0) != 0x80; }));
}

std::string MarkerPath(Marker marker, double x, double y, double r) {
  switch (marker) {
    case Marker::kCircle:
      return fmt::format("M{} {}a{r} {r} 0 1 0 {d} 0a{r} {r} 0 1 0 -{d} 0", Px(x - r), Px(y),
                         fmt::arg("r", Px(r)), fmt::arg("d", Px(2 * r)));
    case Marker::kSquare:
      return fmt::format("M{} {}h{d}v{d}h-{d}z", Px(x - r), Px(y - r), fmt::arg("d", Px(2 * r)));
    case Marker::kTriangle:
      return fmt::format("M{} {}l{} {}h-{}z", Px(x), Px(y - 1.2 * r), Px(1.2 * r), Px(2.1 * r), Px(2.4 * r));
    case Marker::kDiamond:
      return fmt::format("M{} {}l{d} {d}l-{d} {d}l-{d} -{d}z", Px(x), Px(y - 1.3 * r),
                         fmt::arg("d", Px(1.3 * r)));
    case Marker::kCross:
      return fmt::format("M{} {}l{d} {d}m0 -{d}l-{d} {d}", Px(x - r), Px(y - r), fmt::arg("d", Px(2 * r)));
  }
  return "";
}

std::string PointClass(const PointStyle& style) {
  return fmt::format("p-mark {} {}", InkClass(style.ink),
                     style.hollow || style.marker == Marker::kCross ? "p-hollow" : "p-solid");
}

}  // namespace hydroscope
