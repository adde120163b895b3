#include "estimation/signal_noise.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>

#include "core/units.h"

namespace hydroscope {
namespace {

constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();
/// Windows below which nothing can be said.
constexpr std::size_t kLeastWindows = 24;
/// Share of the windows that counts as those where the signal moves least.
constexpr double kQuietShare = 1.0 / 3;
/// Motion over a window of 32 rows, in noise energies, up to which it counts as quiet: noise alone is beyond
/// it in 0.05 %. Curvature that large adds 1/85 to the energy of pairs.
constexpr double kLittleMotion = 12;
/// Growth of what exceeds white noise from pairs to four rows beyond which it is motion (8 for a corner, 32
/// for curvature), not filtered noise (first order: up to 4.7).
constexpr double kMotionGrowth = 6;
/// Energy over four rows that a trace of motion may have.
constexpr double kTrace = 1.5;
/// By how much the energy of all rows may exceed that of quiet ones: half of ExplainOptions::floor_excess.
constexpr double kMotionShare = 1.075;

/// What one window of 4 `reach` rows shows.
struct NoiseWindow {
  double motion = 0;  ///< energy of the contrasts over the whole window and its neighbours, the largest
  std::array<double, 3> energy{};  ///< mean energy of contrasts over 1, 2, 4 rows
};

/// Energies of contrasts of runs of rows, from running sums.
class RunContrasts {
 public:
  explicit RunContrasts(const std::vector<double>& run) : sum_(run.size() + 1, 0.0) {
    for (std::size_t k = 0; k < run.size(); ++k) sum_[k + 1] = sum_[k] + (run[k] - run.front());
  }
  /// + - - + over 4 d rows from `first` on.
  double Second(std::size_t first, std::size_t d) const {
    const double c = Sum(first, d) - Sum(first + d, 2 * d) + Sum(first + 3 * d, d);
    return c * c / (4.0 * static_cast<double>(d));
  }

 private:
  double Sum(std::size_t first, std::size_t rows) const { return sum_[first + rows] - sum_[first]; }

  std::vector<double> sum_;
};

NoiseWindow WindowAt(const RunContrasts& run, std::size_t first, std::size_t reach) {
  NoiseWindow w;
  w.motion = run.Second(first, reach);
  for (std::size_t o = 0, d = 1; o < 3 && d <= reach; ++o, d *= 2) {
    for (std::size_t k = 0; k < reach / d; ++k) w.energy[o] += run.Second(first + 4 * d * k, d);
    w.energy[o] /= static_cast<double>(reach / d);
  }
  return w;
}

/// What moves in one window may have moved beside it: each takes the largest motion of three.
void SpreadMotion(std::span<NoiseWindow> windows) {
  double before = 0;
  for (std::size_t k = 0; k < windows.size(); ++k) {
    const double own = windows[k].motion, after = k + 1 < windows.size() ? windows[k + 1].motion : 0.0;
    windows[k].motion = std::max({before, own, after});
    before = own;
  }
}

std::vector<NoiseWindow> WindowsOf(std::span<const SignalRuns> strokes, std::size_t reach) {
  std::vector<NoiseWindow> windows;
  for (const SignalRuns& stroke : strokes)
    for (const std::vector<double>& run : stroke) {
      const RunContrasts contrasts(run);
      const std::size_t first = windows.size();
      for (std::size_t k = 0; k + 4 * reach <= run.size(); k += 2 * reach)
        windows.push_back(WindowAt(contrasts, k, reach));
      SpreadMotion(std::span(windows).subspan(first));
    }
  return windows;
}

/// A ratio of two mean energies over windows, with its error by chunks of time (jackknife of its logarithm).
struct EnergyRatio {
  double log = 0, error = std::numeric_limits<double>::infinity();
  int chunks = 0;

  double value() const { return std::exp(log); }
};

struct ChunkSums {
  double numerator = 0, denominator = 0, numerator_count = 0, denominator_count = 0;

  double LogRatio() const {
    return std::log(numerator / numerator_count) - std::log(denominator / denominator_count);
  }
};

EnergyRatio RatioOf(std::vector<ChunkSums> chunks) {
  std::erase_if(chunks,
                [](const ChunkSums& c) { return c.numerator_count == 0 && c.denominator_count == 0; });
  ChunkSums total;
  const auto add = [&](const ChunkSums& c, double sign) {
    total.numerator += sign * c.numerator;
    total.denominator += sign * c.denominator;
    total.numerator_count += sign * c.numerator_count;
    total.denominator_count += sign * c.denominator_count;
  };
  for (const ChunkSums& c : chunks) add(c, 1);
  EnergyRatio ratio;
  ratio.chunks = static_cast<int>(chunks.size());
  ratio.log = total.LogRatio();
  if (ratio.chunks < 3 || !std::isfinite(ratio.log)) return ratio;
  double sum = 0, squares = 0;
  for (const ChunkSums& c : chunks) {
    add(c, -1);
    const double rest = total.LogRatio();
    add(c, 1);
    sum += rest;
    squares += rest * rest;
  }
  const double n = ratio.chunks;
  ratio.error = std::sqrt(std::max(0.0, (n - 1) / n * (squares - sum * sum / n)));
  if (!std::isfinite(ratio.error)) ratio.error = std::numeric_limits<double>::infinity();
  return ratio;
}

/// Windows of a signal, and which of them are quiet.
class NoiseWindows {
 public:
  NoiseWindows(std::vector<NoiseWindow> windows, int chunks) : windows_(std::move(windows)), chunks_(chunks) {
    std::vector<double> motion;
    for (const NoiseWindow& w : windows_) motion.push_back(w.motion);
    const auto quiet =
        motion.begin() + static_cast<std::ptrdiff_t>(kQuietShare * static_cast<double>(motion.size()));
    std::nth_element(motion.begin(), quiet, motion.end());
    limit_ = *quiet;
    limit_ = std::max(limit_, kLittleMotion * Energy(0, true));
  }

  /// Mean energy over 2^octave rows.
  double Energy(int octave, bool quiet_only) const {
    double sum = 0, count = 0;
    for (const NoiseWindow& w : windows_) {
      if (quiet_only && w.motion > limit_) continue;
      sum += w.energy[static_cast<std::size_t>(octave)];
      count += 1;
    }
    return sum / count;
  }
  /// Largest motion of a quiet window.
  double limit() const { return limit_; }

  /// Energy over 2^octave rows against single rows, of the quiet windows.
  EnergyRatio OverRows(int octave) const {
    std::vector<ChunkSums> chunks(static_cast<std::size_t>(chunks_));
    for (std::size_t k = 0; k < windows_.size(); ++k) {
      if (windows_[k].motion > limit_) continue;
      ChunkSums& chunk = chunks[k * chunks.size() / windows_.size()];
      chunk.numerator += windows_[k].energy[static_cast<std::size_t>(octave)];
      chunk.denominator += windows_[k].energy[0];
      chunk.numerator_count += 1;
      chunk.denominator_count += 1;
    }
    return RatioOf(std::move(chunks));
  }
  /// Energy over 2^octave rows of all windows against that of the quiet ones.
  EnergyRatio OverQuiet(int octave) const {
    std::vector<ChunkSums> chunks(static_cast<std::size_t>(chunks_));
    for (std::size_t k = 0; k < windows_.size(); ++k) {
      ChunkSums& chunk = chunks[k * chunks.size() / windows_.size()];
      const double energy = windows_[k].energy[static_cast<std::size_t>(octave)];
      chunk.numerator += energy;
      chunk.numerator_count += 1;
      if (windows_[k].motion > limit_) continue;
      chunk.denominator += energy;
      chunk.denominator_count += 1;
    }
    return RatioOf(std::move(chunks));
  }

 private:
  std::vector<NoiseWindow> windows_;
  int chunks_;
  double limit_ = 0;
};

/// Clearly above `factor`, at the significance asked for.
bool ClearlyAbove(const EnergyRatio& ratio, double factor, double significance) {
  if (ratio.chunks < 3 || !std::isfinite(ratio.error)) return false;
  const boost::math::students_t student(ratio.chunks - 1.0);
  return ratio.log - std::log(factor) >
         boost::math::quantile(boost::math::complement(student, significance)) * ratio.error;
}

bool ClearlyBelow(const EnergyRatio& ratio, double factor, double significance) {
  return ClearlyAbove({-ratio.log, ratio.error, ratio.chunks}, 1 / factor, significance);
}

/// Steps between neighbouring readings.
struct ReadingSteps {
  double smallest = 0, median = 0, repeated = 0;

  static ReadingSteps Of(std::span<const SignalRuns> strokes) {
    std::vector<double> steps;
    std::size_t pairs = 0;
    for (const SignalRuns& stroke : strokes)
      for (const std::vector<double>& run : stroke)
        for (std::size_t k = 1; k < run.size(); ++k, ++pairs)
          if (run[k] != run[k - 1]) steps.push_back(std::abs(run[k] - run[k - 1]));
    ReadingSteps out;
    if (pairs == 0) return out;
    out.repeated = 1.0 - static_cast<double>(steps.size()) / static_cast<double>(pairs);
    if (steps.empty()) return out;
    const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
    std::nth_element(steps.begin(), middle, steps.end());
    out.median = *middle;
    // Rounding of decimal numbers makes tiny differences of differences; a step is one that is reached.
    out.smallest = *std::min_element(steps.begin(), steps.end());
    return out;
  }
  /// A resolution, and not readings that are held.
  bool Coarse() const { return median <= 2.5 * smallest; }
};

std::string WithUnit(double si, const std::string& unit) {
  const DisplayUnit shown = unit == "K" ? DisplayUnit{1, 0, "K"} : DisplayUnitFor(unit);
  return fmt::format("{:.3g}{}{}", si * shown.factor, shown.name == "1" || shown.name.empty() ? "" : " ",
                     shown.name == "1" ? "" : shown.name);
}

std::string Milliseconds(double s) { return fmt::format("{:.3g} ms", 1e3 * s); }

/// Widest contrast the runs have room for.
std::vector<NoiseWindow> WidestWindows(std::span<const SignalRuns> strokes, std::size_t& reach) {
  std::vector<NoiseWindow> windows;
  for (reach = 8; reach >= 2; reach /= 2) {
    windows = WindowsOf(strokes, reach);
    if (windows.size() >= 2 * kLeastWindows || reach == 2) break;
  }
  return windows;
}

void DescribeSteps(const ReadingSteps& steps, double period, SignalNoise& noise) {
  const int percent = static_cast<int>(std::lround(100 * noise.repeated));
  if (steps.Coarse()) {
    noise.kind = NoiseKind::kQuantised;
    noise.sentence = fmt::format(
        "{} is read in steps of {}, which hide its noise: {} % of the readings repeat the one before",
        noise.name, WithUnit(noise.quantum, noise.unit), percent);
  } else {
    noise.kind = NoiseKind::kColoured;
    noise.sentence = fmt::format(
        "{} % of the readings of {} repeat the one before: it is updated less often than every {}", percent,
        noise.name, Milliseconds(period));
  }
}

}  // namespace

const char* NoiseKindName(NoiseKind kind) {
  switch (kind) {
    case NoiseKind::kUnknown:
      return "not known";
    case NoiseKind::kWhite:
      return "white";
    case NoiseKind::kColoured:
      return "coloured";
    case NoiseKind::kQuantised:
      return "quantised";
    case NoiseKind::kSignalInContrast:
      return "signal";
    case NoiseKind::kDisagreesWithStated:
      return "not as stated";
  }
  return "not known";
}

SignalNoise JudgeSignalNoise(const std::string& name, const std::string& unit,
                             std::span<const SignalRuns> strokes, double period, double stated,
                             const SignalNoiseOptions& options) {
  SignalNoise noise;
  noise.name = name;
  noise.unit = unit;
  noise.stated = stated;
  const ReadingSteps steps = ReadingSteps::Of(strokes);
  noise.quantum = steps.smallest;
  noise.repeated = steps.repeated;
  std::size_t reach = 0;
  std::vector<NoiseWindow> found = WidestWindows(strokes, reach);
  if (found.size() < kLeastWindows) return noise;
  const NoiseWindows windows(std::move(found), options.chunks);
  noise.std = std::sqrt(windows.Energy(0, false));
  noise.quiet_std = std::sqrt(windows.Energy(0, true));
  if (noise.std <= 0) return noise;
  if (noise.repeated > options.repeated_share) {
    DescribeSteps(steps, period, noise);
    return noise;
  }
  const EnergyRatio pairs = windows.OverRows(1), fours = windows.OverRows(2);
  const EnergyRatio all = windows.OverQuiet(0), all_pairs = windows.OverQuiet(1);
  noise.ratio = pairs.value();
  const double t =
      pairs.chunks > 2 ? boost::math::quantile(boost::math::students_t(pairs.chunks - 1.0), 0.975) : 0;
  noise.ratio_low = std::exp(pairs.log - t * pairs.error);
  noise.ratio_high = std::exp(pairs.log + t * pairs.error);
  noise.slope = pairs.log / std::log(2.0);
  const bool motion = reach == 8 && fours.value() - 1 > kMotionGrowth * (pairs.value() - 1);
  noise.slow_ratio = reach == 8 && !motion ? fours.value() : kNotANumber;

  const double p = options.significance;
  const bool moves = ClearlyAbove(all, kMotionShare, p) && all_pairs.log > 2 * all.log;
  const bool beyond_stated = noise.std > (1 + options.stated_tolerance) * stated;
  const bool below_stated = noise.std * (1 + options.stated_tolerance) < stated;
  const bool stronger =
      !motion && (ClearlyAbove(pairs, options.tolerated_ratio, p) || ClearlyAbove(fours, kTrace, p));
  const bool weaker = ClearlyBelow(pairs, 1 / options.tolerated_ratio, p);
  if (beyond_stated || noise.ratio > options.motion_ratio || moves) {
    noise.kind = NoiseKind::kSignalInContrast;
    noise.seen_at_rest = noise.ratio <= options.motion_ratio && !beyond_stated;
    noise.sentence =
        beyond_stated
            ? fmt::format(
                  "{} scatters by {} from row to row, its stated noise is {}: it moves within the {} over "
                  "which noise is told from motion",
                  name, WithUnit(noise.std, unit), WithUnit(stated, unit), Milliseconds(3 * period))
            : fmt::format(
                  "{} moves within the {} over which noise is told from motion: its noise cannot be seen",
                  name, Milliseconds(3 * period));
  } else if (stronger || weaker) {
    noise.kind = NoiseKind::kColoured;
    const bool four_rows = std::isfinite(noise.slow_ratio) && stronger;
    const double shown = four_rows ? noise.slow_ratio : noise.ratio;
    noise.sentence = fmt::format(
        "noise of {} is not white: over {} rows {:.2g} times as strong as from row to row, {}", name,
        four_rows ? 4 : 2, shown,
        stronger ? "a sensor or controller filters it" : "neighbouring rows are not independent readings");
  } else if (below_stated) {
    noise.kind = NoiseKind::kDisagreesWithStated;
    noise.sentence = fmt::format("{} scatters by {} from row to row, the machine file states a noise of {}",
                                 name, WithUnit(noise.std, unit), WithUnit(stated, unit));
  } else {
    noise.kind = NoiseKind::kWhite;
  }
  return noise;
}

}  // namespace hydroscope
