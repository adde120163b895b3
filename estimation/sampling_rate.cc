#include "estimation/sampling_rate.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "core/contains.h"
#include "core/units.h"

namespace hydroscope {
namespace {

/// Stretches that are looked at, evenly spread.
constexpr std::size_t kStretchesOfRate = 48;
/// Orders of an error in the distance of rows: steps of a signal have 0.5 to 1, a smooth one 2.
constexpr double kLeastOrder = 0.5, kMostOrder = 2;
/// Order at which the error falls on the way to rows near enough: it grows as they come nearer.
constexpr double kOrderOfNearRows = 1.25;
/// Growth of motion from single rows to pairs, at least.
constexpr double kMotionOfPairs = 4;
/// Windows below which nothing is said.
constexpr int kLeastRateWindows = 30;

/// Every `every`-th row, sample 0 among them.
Stretch EveryRow(const Stretch& s, int every) {
  Stretch out;
  out.period = s.period * every;
  out.samples = (s.samples - 1) / every + 1;
  out.before = s.before / every;
  out.after = (s.samples + s.after - 1) / every + 1 - out.samples;
  const int rows = out.before + out.samples + out.after;
  for (std::size_t c = 0; c < s.channel.size(); ++c) {
    std::vector<double>& to = out.channel.emplace_back(static_cast<std::size_t>(rows));
    const double* from = s[static_cast<int>(c)];
    for (int k = 0; k < rows; ++k) to[k] = from[(k - out.before) * every];
  }
  return out;
}

/// Level of a weighted sum of the base columns and the output at each row: integrals, in the level form values.
std::vector<double> Levels(const ModelStructure& model, Stretch& stretch, const Eigen::VectorXd& weights) {
  model.derive_channels(stretch);
  std::vector<double> sum(static_cast<std::size_t>(stretch.samples), 0.0), filled(sum.size());
  for (int c = 0; c <= model.base_count; ++c) {
    double state = 0, level = 0;
    model.columns[c].fill(stretch, state, filled);
    for (std::size_t k = 0; k < sum.size(); ++k) {
      sum[k] += weights[c] * (model.level_form ? filled[k] : level);
      level += filled[k];
    }
  }
  return sum;
}

/// Windows of an output unit over rows four apart: rates of levels, in the level form means.
class RateWindows {
 public:
  RateWindows(const WindowSamples& window, bool level_form)
      : level_form_(level_form), rows_(std::max(4, (window.half_window * window.block + 2) / 4 * 4)) {}

  int rows() const { return rows_; }
  /// Sum of squares of the windows of x(k), k every fourth row of `samples`.
  template <typename Levels>
  double Energy(int samples, double period, Levels x) const {
    double sum = 0;
    for (int k = 0; k + rows_ < samples; k += 4) {
      double value = 0;
      if (level_form_)
        for (int j = 0; j < rows_; j += 4) value += x(k + j) * 4 / rows_;
      else
        value = (x(k + rows_) - x(k)) / (rows_ * period);
      sum += value * value;
    }
    return sum;
  }
  int Count(int samples) const { return std::max(0, (samples - rows_ + 3) / 4); }

 private:
  bool level_form_;
  int rows_;
};

/// Sums over windows: squares of the differences between all, every second, every fourth row, of what noise
/// adds to them, and of the output.
struct RateSums {
  double second = 0, fourth = 0, noise_second = 0, noise_fourth = 0, output = 0;
  int windows = 0;
};

/// Differences of one stretch at the rows that all three have.
struct RowDifferences {
  std::vector<double> second, fourth;
};

RowDifferences DifferencesOf(const ModelStructure& model, const Stretch& stretch,
                             const Eigen::VectorXd& weights) {
  std::array<std::vector<double>, 3> levels;
  for (int o = 0; o < 3; ++o) {
    Stretch thinned = EveryRow(stretch, 1 << o);
    levels[o] = Levels(model, thinned, weights);
  }
  RowDifferences out;
  for (std::size_t k = 0; k < levels[2].size(); ++k) {
    out.second.push_back(levels[1][2 * k] - levels[0][4 * k]);
    out.fourth.push_back(levels[2][k] - levels[1][2 * k]);
  }
  return out;
}

class RateJudge {
 public:
  RateJudge(const ModelStructure& model, const WindowSamples& window, const Eigen::VectorXd& theta,
            std::vector<double> noise)
      : model_(model), windows_(window, model.level_form), noise_(std::move(noise)) {
    weights_.resize(model.base_count + 1);
    weights_ << theta.head(model.base_count), -1.0;
  }

  void Add(const Stretch& stretch) {
    const int samples = stretch.samples;
    if (samples <= windows_.rows()) return;
    const RowDifferences plain = DifferencesOf(model_, stretch, weights_);
    const RowDifferences noisy = DifferencesOf(model_, WithNoise(stretch), weights_);
    const auto energy = [&](auto x) {
      return windows_.Energy(samples, stretch.period,
                             [&](int k) { return x(static_cast<std::size_t>(k / 4)); });
    };
    sums_.second += energy([&](std::size_t k) { return plain.second[k]; });
    sums_.fourth += energy([&](std::size_t k) { return plain.fourth[k]; });
    sums_.noise_second += energy([&](std::size_t k) { return noisy.second[k] - plain.second[k]; });
    sums_.noise_fourth += energy([&](std::size_t k) { return noisy.fourth[k] - plain.fourth[k]; });
    Stretch all = stretch;
    const Eigen::VectorXd output = Eigen::VectorXd::Unit(model_.base_count + 1, model_.base_count);
    const std::vector<double> levels = Levels(model_, all, output);
    sums_.output += windows_.Energy(samples, stretch.period, [&](int k) { return levels[k]; });
    sums_.windows += windows_.Count(samples);
  }
  const RateSums& sums() const { return sums_; }

 private:
  Stretch WithNoise(const Stretch& stretch) {
    Stretch out = stretch;
    for (std::size_t c = 0; c < noise_.size(); ++c)
      if (noise_[c] > 0)
        for (double& x : out.channel[c]) x += (random_() >> 31) != 0 ? noise_[c] : -noise_[c];
    return out;
  }

  const ModelStructure& model_;
  RateWindows windows_;
  std::vector<double> noise_;
  Eigen::VectorXd weights_;
  std::mt19937 random_{7};
  RateSums sums_;
};

/// Share of an energy over single rows that is surely noise: what grows fourfold or more from single rows to pairs is motion.
double ShareOfNoise(double growth) { return std::clamp(1 - (growth - 1) / (kMotionOfPairs - 1), 0.0, 1.0); }

/// Standard deviation of a signal's noise, SI, as far as it is surely noise.
double SureNoise(const SignalNoise& signal, const SamplingRateOptions& options) {
  if (std::isfinite(signal.stated)) return signal.stated;
  const double std = std::min(signal.std, signal.quiet_std);
  if (signal.ratio_high < options.white_ratio && signal.ratio_low > 1 / options.white_ratio) {
    // Less over pairs than over single rows is neither: motion near the sampling rate.
    if (!(signal.loud_growth > 1 / options.white_ratio)) return std;
    const double louder = signal.std * signal.std - std * std;  // comes in bursts, or moves
    return std::sqrt(std * std + louder * ShareOfNoise(signal.loud_growth));
  }
  if (signal.std > options.noise_of_range * signal.range) return 0;
  return std * std::sqrt(ShareOfNoise(signal.ratio));
}

std::vector<double> NoiseOfChannels(const ModelStructure& model, const FloorTrust& trust,
                                    const SamplingRateOptions& options) {
  std::vector<double> noise(model.channel_source.size(), 0.0);
  for (std::size_t c = 0; c < noise.size(); ++c)
    for (const SignalNoise& signal : trust.signals)
      if (signal.name == model.channel_names[c] && signal.std > 0) noise[c] = SureNoise(signal, options);
  return noise;
}

Told RowsEvery(double period) {
  return TellNumber(period < 1 ? fmt::format("{:.3g} ms", 1e3 * period) : fmt::format("{:.3g} s", period));
}

/// The next shorter 1, 2, 5 times a power of ten.
double RoundedDown(double period) {
  const double decade = std::pow(10.0, std::floor(std::log10(period)));
  for (const double digit : {5.0, 2.0})
    if (period >= digit * decade * 0.999) return digit * decade;
  return decade;
}

void DescribeSlow(const std::string& unit, SamplingRate& rate) {
  const DisplayUnit shown = DisplayUnitFor(unit);
  rate.why = Tell("sampled too slowly", "zu langsam abgetastet");
  rate.sentence = Tell(
      "sampled too slowly for this: rows every {}, this balance needs {} or faster (the distance of the rows "
      "alone causes an error of {:.2g} {}, {:.2g} % of the output)",
      "zu langsam abgetastet dafür: eine Zeile alle {}, diese Bilanz braucht eine alle {} oder schneller (der Abstand "
      "der Zeilen allein macht einen Fehler von {:.2g} {}, {:.2g} % des Ausgangs)",
      RowsEvery(rate.period), RowsEvery(rate.needed_period), rate.error * shown.factor,
      shown.name.empty() ? unit : std::string(shown.name), 100 * rate.error / rate.output);
}

/// Whether what a signal scatters by beyond its quiet rows may as well be noise that comes in bursts.
bool MayComeInBursts(const SignalNoise& signal, const SamplingRateOptions& options) {
  return signal.std * signal.std > options.burst_energy * signal.quiet_std * signal.quiet_std &&
         signal.loud_growth < options.burst_growth;
}

/// The signal of the balance with the largest share of its noise that may come in bursts; nullptr if none does.
const SignalNoise* SignalWithBursts(const ModelStructure& model, const FloorTrust& trust,
                                    const SamplingRateOptions& options) {
  for (const SignalNoise& signal : trust.signals)
    if (Contains(model.channel_names, signal.name) && MayComeInBursts(signal, options)) return &signal;
  return nullptr;
}

void DescribeBursts(const SignalNoise& signal, SamplingRate& rate) {
  rate.why = Tell("noise of {} in bursts, or sampled too slowly",
                  "Rauschen von {} in Stößen, oder zu langsam abgetastet", signal.name);
  rate.sentence = Tell(
      "noise of {} comes in bursts, or rows every {} are too slow for what it does: from row to row it scatters by {}, by "
      "{} where it is quiet; see to its cable and sensor, or record rows every {} or faster",
      "das Rauschen von {} kommt in Stößen, oder eine Zeile alle {} ist zu langsam für das, was es tut: von Zeile zu Zeile streut es "
      "um {}, um {}, wo es ruhig ist; Kabel und Sensor prüfen, oder eine Zeile alle {} oder schneller aufzeichnen",
      signal.name, RowsEvery(rate.period), WithUnit(signal.std, signal.unit),
      WithUnit(signal.quiet_std, signal.unit), RowsEvery(rate.needed_period));
}

}  // namespace

SamplingRate JudgeSamplingRate(const ModelStructure& model, std::span<const std::vector<Stretch>> strokes,
                               const WindowSamples& window, const Eigen::VectorXd& theta,
                               const FloorTrust& trust, double noise_floor,
                               const SamplingRateOptions& options) {
  SamplingRate rate;
  rate.period = rate.needed_period = window.period;
  rate.needed_rate_hz = 1 / window.period;
  RateJudge judge(model, window, theta, NoiseOfChannels(model, trust, options));
  std::vector<const Stretch*> stretches;
  for (const auto& stroke : strokes)
    for (const Stretch& stretch : stroke) stretches.push_back(&stretch);
  const std::size_t count = std::min(stretches.size(), kStretchesOfRate);
  for (std::size_t k = 0; k < count; ++k) judge.Add(*stretches[k * stretches.size() / count]);
  const RateSums& sums = judge.sums();
  if (sums.windows < kLeastRateWindows) return rate;

  const double second = std::max(0.0, sums.second - sums.noise_second) / sums.windows;
  const double fourth = std::max(0.0, sums.fourth - sums.noise_fourth) / sums.windows;
  rate.output = std::sqrt(sums.output / sums.windows);
  const double order =
      second > 0 ? std::clamp(0.5 * std::log2(fourth / second), kLeastOrder, kMostOrder) : kMostOrder;
  rate.error = std::sqrt(second) / (std::pow(2.0, order) - 1);
  const double scale = std::isfinite(trust.noise_scale) ? std::min(1.0, trust.noise_scale) : 0.0;
  const double of_floor = options.floor_share * noise_floor * std::sqrt(std::max(0.0, scale));
  rate.allowed = std::clamp(of_floor, options.least_share * rate.output, options.most_share * rate.output);
  // A difference that noise alone would give in one case of many is no evidence.
  const bool seen = sums.second > 2 * sums.noise_second;
  rate.fast_enough = !(seen && rate.error > rate.allowed);
  if (rate.fast_enough) return rate;
  rate.needed_period =
      RoundedDown(rate.period * std::pow(rate.allowed / rate.error, 1 / std::max(order, kOrderOfNearRows)));
  rate.needed_rate_hz = 1 / rate.needed_period;
  if (const SignalNoise* bursts = SignalWithBursts(model, trust, options))
    DescribeBursts(*bursts, rate);
  else
    DescribeSlow(model.output_unit, rate);
  return rate;
}

}  // namespace hydroscope
