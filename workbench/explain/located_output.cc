#include "workbench/explain/located_output.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <span>

#include "core/constants.h"
#include "core/interval_text.h"
#include "core/non_negative.h"
#include "core/short_number.h"

namespace hydroscope {
namespace {

/// Of numbers none.
std::string_view UnitUnlessNumber(std::string_view unit) { return unit == "1" ? "" : unit; }

}  // namespace

std::string LocatedText(const std::vector<Located>& located, const DisplayUnit& unit,
                        const std::string& output) {
  constexpr std::size_t kShown = 6;
  if (located.empty()) return "";
  std::string text =
      fmt::format("\nWhere the model errs{} ({}noise taken out)\n", output.empty() ? "" : " in " + output,
                  unit.name == "1" ? "" : fmt::format("{}, ", unit.name));
  const std::span shown(located.data(), std::min(located.size(), kShown));
  std::size_t width = 6;
  for (const Located& l : shown) width = std::max(width, l.signal.size());
  text += fmt::format("  {:<{}} {:>17} {:<5} {:>8} {:>9} {:>9} {:>8}\n", "signal", width, "from ... to", "",
                      "rms", "mean", "of error", "of time");
  for (const Located& l : shown)
    text += fmt::format("  {:<{}} {:>17} {:<5} {:>8} {:>9} {:>7.0f} % {:>6.0f} %\n", l.signal, width,
                        ShortNumber(l.from) + " ... " + ShortNumber(l.to), UnitUnlessNumber(l.unit),
                        ShortNumber(l.rms * unit.factor),
                        (l.mean > 0 ? "+" : "") + ShortNumber(l.mean * unit.factor, 2), 100 * l.share_error,
                        100 * l.share_windows);
  return text;
}

nlohmann::json LocatedJson(const std::vector<Located>& located, double factor) {
  nlohmann::json out = nlohmann::json::array();
  for (const Located& l : located)
    out.push_back({{"signal", l.signal},
                   {"from", l.from},
                   {"to", l.to},
                   {"unit", l.unit},
                   {"rms", l.rms * factor},
                   {"mean", l.mean * factor},
                   {"share_error", l.share_error},
                   {"share_windows", l.share_windows}});
  return out;
}

namespace {

nlohmann::json MapJson(const ErrorMap& map, const std::vector<ResidualSignal>& signals, double factor) {
  nlohmann::json names = nlohmann::json::array(), units = names, cells = names;
  for (int s : map.signals) {
    names.push_back(signals[s].name);
    units.push_back(signals[s].unit);
  }
  for (const MapCell& cell : map.cells) {
    nlohmann::json from = nlohmann::json::array(), to = from;
    for (std::size_t k = 0; k < map.signals.size(); ++k) {
      const ResidualSignal& signal = signals[map.signals[k]];
      from.push_back(cell.from[k] * signal.factor + signal.offset);
      to.push_back(cell.to[k] * signal.factor + signal.offset);
    }
    cells.push_back({{"from", from},
                     {"to", to},
                     {"rms", std::sqrt(NonNegative(cell.excess)) * factor},
                     {"excess", cell.excess * factor * factor},
                     {"excess_std", cell.excess_std * factor * factor},
                     {"mean", cell.mean * factor},
                     {"mean_std", cell.mean_std * factor},
                     {"windows", cell.windows},
                     {"strokes", cell.strokes},
                     {"above_floor", cell.above_floor}});
  }
  return {{"signals", names}, {"units", units}, {"explained", map.explained}, {"cells", cells}};
}

}  // namespace

nlohmann::json MapsJson(const ErrorLocation& location, const std::vector<ResidualSignal>& signals,
                        double factor) {
  constexpr std::size_t kPairs = 3;
  nlohmann::json out = nlohmann::json::array();
  for (const ErrorMap& map : location.single) out.push_back(MapJson(map, signals, factor));
  for (std::size_t k = 0; k < std::min(kPairs, location.pairs.size()); ++k)
    out.push_back(MapJson(location.pairs[k], signals, factor));
  return out;
}

std::string RemainderText(const RemainderShape& shape, double factor, std::string_view unit,
                          const std::string& equation) {
  constexpr int kBarWidth = 12, kEvery = 3;
  double largest = 0;
  for (const ShapePoint& p : shape.points) largest = std::max(largest, std::abs(p.value));
  std::string text =
      fmt::format("\nShape of what is missing{}, over {} (follows {:.0f} % of the error){}\n",
                  equation.empty() ? "" : fmt::format(" in the equation of {}", equation), shape.signal,
                  100 * shape.explained, equation.empty() ? ", measured less modelled" : "");
  for (std::size_t k = 0; k < shape.points.size(); k += kEvery) {
    const ShapePoint& p = shape.points[k];
    const int bar = largest > 0 ? static_cast<int>(std::lround(kBarWidth * std::abs(p.value) / largest)) : 0;
    const std::string left = p.value < 0 ? std::string(bar, '#') : "",
                      right = p.value >= 0 ? std::string(bar, '#') : "";
    text +=
        fmt::format("  {:>9} {:<5} {:>12}|{:<12} {} {}\n", ShortNumber(p.x, 4), UnitUnlessNumber(shape.unit),
                    left, right, ChangeWithInterval(p.value * factor, kNormal95 * p.std * factor), unit);
  }
  return text;
}

nlohmann::json RemainderJson(const RemainderShape& shape, double factor) {
  nlohmann::json points = nlohmann::json::array();
  for (const ShapePoint& point : shape.points)
    points.push_back({{"x", point.x}, {"value", point.value * factor}, {"std", point.std * factor}});
  return {{"signal", shape.signal}, {"unit", shape.unit}, {"explained", shape.explained}, {"points", points}};
}

}  // namespace hydroscope
