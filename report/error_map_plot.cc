#include "report/error_map_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "core/constants.h"
#include "core/non_negative.h"
#include "report/svg_plot.h"

namespace hydroscope {
namespace {

/// "p_{A} (bar)"; of what begins with a word, as "pressure_rate", nothing is an index.
std::string AxisName(const ResidualSignal& signal) {
  constexpr std::size_t kLongestSymbol = 3;
  const auto line = signal.name.find('_');
  std::string name = signal.name;
  if (line != std::string::npos && line <= kLongestSymbol)
    name = signal.name.substr(0, line + 1) + "{" + signal.name.substr(line + 1) + "}";
  return signal.unit.empty() ? name : fmt::format("{} ({})", name, signal.unit);
}

}  // namespace

std::vector<double> MapEdges(const ErrorMap& map, const std::vector<ResidualSignal>& signals,
                             std::size_t axis) {
  std::set<double> edges;
  for (const MapCell& cell : map.cells) edges.insert({cell.from[axis], cell.to[axis]});
  const ResidualSignal& signal = signals[map.signals[axis]];
  std::vector<double> shown;
  for (const double edge : edges) shown.push_back(edge * signal.factor + signal.offset);
  return shown;
}

std::string ErrorMapPlot(const ErrorMap& map, const std::vector<ResidualSignal>& signals,
                         const DisplayUnit& unit, bool diverging) {
  const std::vector<double> x = MapEdges(map, signals, 0), y = MapEdges(map, signals, 1);
  if (x.size() < 2 || y.size() < 2) return "";
  std::vector<double> values((x.size() - 1) * (y.size() - 1), kNaN);
  const auto place = [&](const std::vector<double>& edges, double si, const ResidualSignal& signal) {
    const double shown = si * signal.factor + signal.offset;
    return static_cast<std::size_t>(std::ranges::lower_bound(edges, shown - 1e-9 * std::abs(shown)) -
                                    edges.begin());
  };
  for (const MapCell& cell : map.cells) {
    if (cell.windows == 0) continue;
    const std::size_t column = place(x, cell.from[0], signals[map.signals[0]]);
    const std::size_t row = place(y, cell.from[1], signals[map.signals[1]]);
    const double value = diverging ? cell.mean : std::sqrt(NonNegative(cell.excess));
    if (column + 1 < x.size() && row + 1 < y.size())
      values[row * (x.size() - 1) + column] = value * unit.factor;
  }
  SvgPlot::Options options;
  options.width = 560;
  options.height = 330;
  options.title = diverging ? "mean of measured minus modelled" : "model error, sensor noise taken out";
  options.x_label = AxisName(signals[map.signals[0]]);
  options.y_label = AxisName(signals[map.signals[1]]);
  SvgPlot plot(options);
  plot.HeatMap(x, y, values, diverging,
               fmt::format("{} ({})", diverging ? "measured − model" : "error, rms", unit.name));
  return plot.Render();
}

}  // namespace hydroscope
