#include "diagnosis/remainder/tone_search.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <unsupported/Eigen/FFT>
#include <vector>

namespace hydroscope {
namespace {

using Line = std::complex<double>;

constexpr double kLowestTone = 2.0;   ///< Hz; below it a span of 0.4 s takes most of a tone away
constexpr double kHighestTone = 0.8;  ///< of the Nyquist frequency
constexpr double kLocal = 1.0;        ///< Hz, half width of the neighbourhood a line must stand out of
constexpr double kChance = 1e-3;      ///< of a line by chance in a whole log
constexpr double kOfStrokes = 0.5;    ///< share of a line's power beyond which it is the strokes' own
constexpr std::size_t kMostGridPoints = 1 << 18;  ///< of the transform; longer logs are thinned

/// What the model leaves of one stretch as a level, samples 0 ... without mean and slope.
struct LevelRest {
  double begin = 0;  ///< s
  std::size_t stroke = 0;
  std::vector<double> level;
};

void TakeLineOut(std::vector<double>& x) {
  const double n = static_cast<double>(x.size()), middle = 0.5 * (n - 1);
  double mean = 0, slope = 0;
  for (std::size_t k = 0; k < x.size(); ++k) {
    mean += x[k] / n;
    slope += x[k] * (static_cast<double>(k) - middle);
  }
  slope /= n * (n * n - 1) / 12;
  for (std::size_t k = 0; k < x.size(); ++k) x[k] -= mean + slope * (static_cast<double>(k) - middle);
}

std::vector<LevelRest> RestsOf(const ModelStructure& model, std::span<const StrokeStretches> strokes,
                               const Eigen::VectorXd& weights) {
  std::vector<int> used;
  for (int c = 0; c < model.column_count(); ++c)
    if (c == model.output_column() || (c < weights.size() && weights[c] != 0.0)) used.push_back(c);
  std::vector<LevelRest> rests;
  std::vector<double> increments, states(used.size());
  Stretch s;
  for (std::size_t stroke = 0; stroke < strokes.size(); ++stroke)
    for (const Stretch& kept : strokes[stroke]) {
      s = kept;
      model.derive_channels(s);
      increments.resize(static_cast<std::size_t>(s.samples) - 1);
      LevelRest rest{s.begin, stroke, std::vector<double>(static_cast<std::size_t>(s.samples), 0.0)};
      for (std::size_t u = 0; u < used.size(); ++u) {
        model.columns[used[u]].fill(s, states[u], increments);
        const double weight = used[u] == model.output_column() ? 1.0 : -weights[used[u]];
        for (std::size_t k = 0; k < increments.size(); ++k) rest.level[k + 1] += weight * increments[k];
      }
      for (std::size_t k = 1; k < rest.level.size(); ++k) rest.level[k] += rest.level[k - 1];
      if (!std::all_of(rest.level.begin(), rest.level.end(), [](double x) { return std::isfinite(x); }))
        continue;
      TakeLineOut(rest.level);
      rests.push_back(std::move(rest));
    }
  return rests;
}

/// Sum of level times exp(-i omega t) of each stroke, t of the log, or since the stroke's first sample.
std::vector<Line> LinesOf(const std::vector<LevelRest>& rests, double period, double frequency,
                          bool since_stroke) {
  std::vector<Line> lines;
  const double omega = 2 * std::numbers::pi * frequency;
  double origin = 0;
  for (std::size_t r = 0; r < rests.size(); ++r) {
    if (r == 0 || rests[r].stroke != rests[r - 1].stroke) {
      lines.emplace_back(0.0);
      origin = since_stroke ? rests[r].begin : 0.0;
    }
    Line turn = std::polar(1.0, -omega * (rests[r].begin - origin));
    const Line step = std::polar(1.0, -omega * period);
    for (const double x : rests[r].level) {
      lines.back() += x * turn;
      turn *= step;
    }
  }
  return lines;
}

double Power(const std::vector<Line>& lines) {
  Line sum = 0;
  for (const Line& line : lines) sum += line;
  return std::norm(sum);
}

/// Periodogram of the whole log, zero where nothing is known; `step` Hz between its bins.
std::vector<double> Periodogram(const std::vector<LevelRest>& rests, double period, double& step) {
  const double first = rests.front().begin;
  const double seconds = rests.back().begin - first + period * static_cast<double>(rests.back().level.size());
  int thin = 1;  // samples per point
  std::size_t points = 64;
  for (; static_cast<double>(kMostGridPoints) * period * thin < seconds; ++thin) {
  }
  while (static_cast<double>(points) * period * thin < seconds) points *= 2;
  std::vector<double> grid(points, 0.0);
  for (const LevelRest& rest : rests) {
    const auto at = static_cast<std::size_t>(std::max(0.0, std::round((rest.begin - first) / period)));
    for (std::size_t k = 0; k < rest.level.size(); ++k)
      if (const std::size_t point = (at + k) / static_cast<std::size_t>(thin); point < points)
        grid[point] += rest.level[k];
  }
  Eigen::FFT<double> fft;
  fft.SetFlag(Eigen::FFT<double>::HalfSpectrum);
  std::vector<Line> spectrum;
  fft.fwd(spectrum, grid);
  std::vector<double> power;
  for (const Line& line : spectrum) power.push_back(std::norm(line));
  step = 1.0 / (static_cast<double>(points) * period * thin);
  return power;
}

/// Frequency that stands most above its neighbours, and by how many times their mean (of chance, whose median
/// is ln 2 of it). The median is that of bands half a neighbourhood wide, which is near enough.
std::pair<double, double> MostOutstanding(const std::vector<double>& power, double step) {
  const auto band = std::max<std::size_t>(16, static_cast<std::size_t>(kLocal / step));
  const auto first = static_cast<std::size_t>(kLowestTone / step);
  const auto last = static_cast<std::size_t>(kHighestTone * static_cast<double>(power.size() - 1));
  std::pair<double, double> best{0, 0};
  std::vector<double> sorted;
  for (std::size_t from = first; from + band <= last; from += band) {
    const std::size_t low = from - std::min(from, band / 2),
                      high = std::min(power.size(), from + band + band / 2);
    sorted.assign(power.begin() + static_cast<std::ptrdiff_t>(low),
                  power.begin() + static_cast<std::ptrdiff_t>(high));
    const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
    std::nth_element(sorted.begin(), middle, sorted.end());
    const double mean = *middle / std::numbers::ln2;
    const auto top = std::max_element(power.begin() + static_cast<std::ptrdiff_t>(from),
                                      power.begin() + static_cast<std::ptrdiff_t>(from + band));
    if (mean > 0 && *top / mean > best.second)
      best = {static_cast<double>(top - power.begin()) * step, *top / mean};
  }
  return best;
}

/// The top of a line within a bin of `frequency`, by golden section.
double TopOf(const std::vector<LevelRest>& rests, double period, double frequency, double step) {
  const double golden = 0.5 * (std::sqrt(5.0) - 1.0);
  double low = frequency - step, high = frequency + step;
  constexpr int kSections = 14;  // narrows two bins by a factor of 800
  for (int k = 0; k < kSections; ++k) {
    const double a = high - golden * (high - low), b = low + golden * (high - low);
    const bool left = Power(LinesOf(rests, period, a, false)) > Power(LinesOf(rests, period, b, false));
    (left ? high : low) = left ? b : a;
  }
  return 0.5 * (low + high);
}

}  // namespace

std::optional<Tone> FindTone(const ModelStructure& model, std::span<const StrokeStretches> strokes,
                             const Eigen::VectorXd& weights) {
  const std::vector<LevelRest> rests = RestsOf(model, strokes, weights);
  if (rests.empty()) return std::nullopt;
  double period = 0;
  for (const StrokeStretches& stroke : strokes)
    for (const Stretch& s : stroke) period = s.period;
  double step = 0;
  const std::vector<double> power = Periodogram(rests, period, step);
  const auto [near, stands_out] = MostOutstanding(power, step);
  if (stands_out < std::log(static_cast<double>(power.size()) / kChance)) return std::nullopt;
  const double frequency = TopOf(rests, period, near, step);
  const std::vector<Line> lines = LinesOf(rests, period, frequency, false);
  if (Power(LinesOf(rests, period, frequency, true)) > kOfStrokes * Power(lines)) return std::nullopt;
  Line sum = 0;
  for (const Line& line : lines) sum += line;
  std::size_t samples = 0;
  for (const LevelRest& rest : rests) samples += rest.level.size();
  // Of a flow a sin(omega t + phase) the level is -a / omega cos(omega t + phase).
  const double omega = 2 * std::numbers::pi * frequency;
  return Tone{frequency, std::arg(-sum), 2 * omega * std::abs(sum) / static_cast<double>(samples)};
}

bool AddSearchedShapes(ModelStructure& model, std::span<const StrokeStretches> strokes,
                       const Eigen::VectorXd& weights) {
  bool added = false;
  for (int e = 0; e < static_cast<int>(model.effects.size()); ++e) {
    if (!model.effects[e]->grid.empty()) continue;
    const std::optional<Tone> tone = FindTone(model, strokes, weights);
    if (!tone) return false;
    const int shape = AddShape(model, e, {tone->frequency, tone->phase});
    model.effect_shapes[e][static_cast<std::size_t>(shape)].refined = true;
    added = true;
  }
  return added;
}

}  // namespace hydroscope
