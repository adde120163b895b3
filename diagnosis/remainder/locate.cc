#include "diagnosis/remainder/locate.h"

#include <algorithm>
#include <cmath>

#include "core/distributions.h"
#include "core/non_negative.h"

namespace hydroscope {
namespace {

/// Of the noise energy: less excess than this is none.
constexpr double kRounding = 1e-9;

/// Sums of one stroke in one cell.
struct CellSums {
  double windows = 0;
  double excess = 0;    ///< sum of squared residual less noise variance
  double residual = 0;  ///< sum
  double noise = 0;     ///< sum of noise variance

  CellSums& operator+=(const CellSums& other) {
    windows += other.windows;
    excess += other.excess;
    residual += other.residual;
    noise += other.noise;
    return *this;
  }
};
using StrokeCells = std::vector<CellSums>;  ///< per stroke

/// A ratio of sums over strokes with its standard error clustered by stroke.
struct Ratio {
  double value = 0, std = INFINITY;
  int strokes = 0;
};

template <typename Numerator>
Ratio ClusteredRatio(const StrokeCells& cells, Numerator numerator) {
  Ratio out;
  double top = 0, windows = 0;
  for (const CellSums& s : cells) {
    top += numerator(s);
    windows += s.windows;
    out.strokes += s.windows > 0;
  }
  if (windows <= 0) return out;
  out.value = top / windows;
  if (out.strokes < 2) return out;
  double spread = 0;
  for (const CellSums& s : cells) {
    const double deviation = numerator(s) - out.value * s.windows;
    spread += deviation * deviation;
  }
  out.std = std::sqrt(spread * out.strokes / (out.strokes - 1.0)) / windows;
  return out;
}

double Squared(double x) { return x * x; }

/// Quantiles of a signal over all windows, `bins` + 1 edges, duplicates dropped.
std::vector<double> QuantileEdges(const Residuals& residuals, int signal, int bins) {
  std::vector<double> values;
  for (const StrokeResiduals& stroke : residuals.strokes)
    for (int w = 0; w < stroke.windows(); ++w) values.push_back(stroke.signal(signal, w));
  std::sort(values.begin(), values.end());
  std::vector<double> edges;
  for (int b = 0; b <= bins && !values.empty(); ++b)
    edges.push_back(values[std::min(
        values.size() - 1, values.size() * static_cast<std::size_t>(b) / static_cast<std::size_t>(bins))]);
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  return edges;
}

int BinOf(const std::vector<double>& edges, double value) {
  const auto at = std::upper_bound(edges.begin() + 1, edges.end() - 1, value);
  return static_cast<int>(at - edges.begin()) - 1;
}

/// A map under construction: cells of all strokes.
struct Binned {
  std::vector<int> signals;
  std::vector<std::vector<double>> edges;  ///< per signal
  std::vector<StrokeCells> cells;          ///< [cell][stroke]
};

Binned Bin(const Residuals& residuals, std::vector<int> signals, int bins) {
  Binned out{std::move(signals), {}, {}};
  std::size_t count = 1;
  for (int signal : out.signals) {
    out.edges.push_back(QuantileEdges(residuals, signal, bins));
    count *= out.edges.back().size() > 1 ? out.edges.back().size() - 1 : 0;
  }
  out.cells.assign(count, StrokeCells(residuals.strokes.size()));
  if (count == 0) return out;
  for (std::size_t s = 0; s < residuals.strokes.size(); ++s) {
    const StrokeResiduals& stroke = residuals.strokes[s];
    for (int w = 0; w < stroke.windows(); ++w) {
      std::size_t cell = 0;
      for (std::size_t k = 0; k < out.signals.size(); ++k)
        cell = cell * (out.edges[k].size() - 1) +
               static_cast<std::size_t>(BinOf(out.edges[k], stroke.signal(out.signals[k], w)));
      CellSums& sums = out.cells[cell][s];
      const double residual = stroke.measured[w] - stroke.modelled[w];
      sums.windows += 1;
      sums.excess += Squared(residual) - stroke.noise_variance[w];
      sums.residual += residual;
      sums.noise += stroke.noise_variance[w];
    }
  }
  return out;
}

/// Energy that cell means predict on strokes left out, per the whole excess energy; 0 if there is none.
double ExplainedShare(const Binned& binned, double total_excess) {
  double removed = 0;
  for (const StrokeCells& cell : binned.cells) {
    double windows = 0, residual = 0;
    for (const CellSums& s : cell) {
      windows += s.windows;
      residual += s.residual;
    }
    for (const CellSums& s : cell) {
      if (s.windows <= 0 || windows <= s.windows) continue;
      const double mean = (residual - s.residual) / (windows - s.windows);
      removed += mean * (2 * s.residual - mean * s.windows);
    }
  }
  return total_excess > 0 ? std::min(1.0, removed / total_excess) : 0.0;
}

/// Whether sensor noise alone leaves as much in one of `tests` cells with chance p_floor: the sum of n
/// squares of normal numbers of variance v, of which `overlap` neighbours share noise, has the standard
/// deviation v sqrt(2 overlap n).
bool IsAboveFloor(const MapCell& cell, int tests, const LocateOptions& options) {
  if (cell.windows < options.min_windows || cell.strokes < options.min_strokes) return false;
  const double chance =
      NormalExceededWith(options.p_floor / tests) * std::sqrt(2 * options.overlap / cell.windows);
  return cell.excess > std::max(options.floor_excess, chance) * cell.noise;
}

ErrorMap MapOf(const Binned& binned, double total_excess, int tests, const LocateOptions& options) {
  ErrorMap map;
  map.signals = binned.signals;
  map.explained = ExplainedShare(binned, total_excess);
  for (std::size_t c = 0; c < binned.cells.size(); ++c) {
    MapCell cell;
    std::size_t rest = c;
    for (std::size_t k = binned.signals.size(); k-- > 0;) {
      const std::size_t bin = rest % (binned.edges[k].size() - 1);
      rest /= binned.edges[k].size() - 1;
      cell.from.insert(cell.from.begin(), binned.edges[k][bin]);
      cell.to.insert(cell.to.begin(), binned.edges[k][bin + 1]);
    }
    const Ratio excess = ClusteredRatio(binned.cells[c], [](const CellSums& s) { return s.excess; });
    const Ratio mean = ClusteredRatio(binned.cells[c], [](const CellSums& s) { return s.residual; });
    CellSums sums;
    for (const CellSums& s : binned.cells[c]) sums += s;
    cell.windows = sums.windows;
    cell.noise = sums.windows > 0 ? sums.noise / sums.windows : 0.0;
    cell.strokes = excess.strokes;
    cell.excess = excess.value;
    cell.excess_std = excess.std;
    cell.mean = mean.value;
    cell.mean_std = mean.std;
    cell.above_floor = IsAboveFloor(cell, tests, options);
    map.cells.push_back(std::move(cell));
  }
  return map;
}

/// Cells first ... last of each stroke, or the others.
StrokeCells Sum(const std::vector<StrokeCells>& cells, std::size_t first, std::size_t last, bool inside) {
  StrokeCells out(cells.front().size());
  for (std::size_t c = 0; c < cells.size(); ++c)
    if ((c >= first && c <= last) == inside)
      for (std::size_t s = 0; s < out.size(); ++s) out[s] += cells[c][s];
  return out;
}

/// Whether cells first ... last err more than the other cells of the map, whichever stroke is left out.
bool WorseThanTheRest(const Binned& binned, std::size_t first, std::size_t last,
                      const LocateOptions& options) {
  const StrokeCells here = Sum(binned.cells, first, last, true), rest = Sum(binned.cells, first, last, false);
  CellSums in, out;
  for (const CellSums& s : here) in += s;
  for (const CellSums& s : rest) out += s;
  for (std::size_t s = 0; s < here.size(); ++s) {
    const double in_windows = in.windows - here[s].windows, out_windows = out.windows - rest[s].windows;
    if (in_windows <= 0 || out_windows <= 0) return false;
    const double error = (in.excess - here[s].excess) / in_windows;
    const double elsewhere = std::max(0.0, (out.excess - rest[s].excess) / out_windows);
    if (error <= options.above_rest * elsewhere) return false;
  }
  return true;
}

Located Describe(const Residuals& residuals, const Binned& binned, std::size_t first, std::size_t last) {
  const ResidualSignal& signal = residuals.signals[binned.signals[0]];
  const StrokeCells here = Sum(binned.cells, first, last, true),
                    all = Sum(binned.cells, 0, binned.cells.size(), true);
  CellSums in, total;
  for (const CellSums& s : here) in += s;
  for (const CellSums& s : all) total += s;
  Located out;
  out.signal = signal.name;
  out.unit = signal.unit;
  out.from = binned.edges[0][first] * signal.factor + signal.offset;
  out.to = binned.edges[0][last + 1] * signal.factor + signal.offset;
  out.rms = std::sqrt(NonNegative(in.excess / in.windows));
  out.mean = in.residual / in.windows;
  out.share_windows = in.windows / total.windows;
  out.share_error = std::clamp(total.excess > 0 ? in.excess / total.excess : 0.0, 0.0, 1.0);
  return out;
}

/// Runs of cells above the floor that err more than the rest of the map.
std::vector<Located> LocatedOn(const Residuals& residuals, const Binned& binned, const ErrorMap& map,
                               const LocateOptions& options) {
  std::vector<Located> out;
  const auto is_located = [&](std::size_t c) {
    return map.cells[c].above_floor && WorseThanTheRest(binned, c, c, options);
  };
  for (std::size_t first = 0; first < map.cells.size(); ++first) {
    if (!is_located(first)) continue;
    std::size_t last = first;
    while (last + 1 < map.cells.size() && is_located(last + 1)) ++last;
    out.push_back(Describe(residuals, binned, first, last));
    first = last;
  }
  return out;
}

}  // namespace

ErrorLocation Locate(const Residuals& residuals, const LocateOptions& options) {
  ErrorLocation out;
  StrokeCells whole;
  double total_excess = 0, total_noise = 0;
  for (const StrokeResiduals& stroke : residuals.strokes) {
    CellSums sums;
    for (int w = 0; w < stroke.windows(); ++w) {
      sums.windows += 1;
      sums.excess += Squared(stroke.measured[w] - stroke.modelled[w]) - stroke.noise_variance[w];
    }
    for (const double variance : stroke.noise_variance) total_noise += variance;
    total_excess += sums.excess;
    whole.push_back(sums);
  }
  if (total_excess < kRounding * total_noise) total_excess = 0;
  const Ratio excess = ClusteredRatio(whole, [](const CellSums& s) { return s.excess; });
  out.excess = excess.value;
  out.excess_std = excess.std;
  const int signals = static_cast<int>(residuals.signals.size());
  const int tests = std::max(1, signals * options.bins);
  for (int a = 0; a < signals; ++a) {
    const Binned binned = Bin(residuals, {a}, options.bins);
    if (binned.cells.size() < 2) continue;
    out.single.push_back(MapOf(binned, total_excess, tests, options));
    const auto located = LocatedOn(residuals, binned, out.single.back(), options);
    out.located.insert(out.located.end(), located.begin(), located.end());
    for (int b = a + 1; b < signals; ++b) {
      const Binned pair = Bin(residuals, {a, b}, options.pair_bins);
      if (pair.cells.size() >= 4)
        out.pairs.push_back(MapOf(pair, total_excess, options.pair_bins * options.pair_bins, options));
    }
  }
  const auto better = [](const ErrorMap& x, const ErrorMap& y) { return x.explained > y.explained; };
  std::stable_sort(out.single.begin(), out.single.end(), better);
  std::stable_sort(out.pairs.begin(), out.pairs.end(), better);
  std::stable_sort(out.located.begin(), out.located.end(), [](const Located& x, const Located& y) {
    return x.share_error - x.share_windows > y.share_error - y.share_windows;
  });
  return out;
}

}  // namespace hydroscope
