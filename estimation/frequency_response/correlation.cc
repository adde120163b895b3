#include "estimation/frequency_response/correlation.h"

#include <Eigen/Dense>
#include <algorithm>
#include <boost/math/special_functions/digamma.hpp>
#include <boost/math/special_functions/trigamma.hpp>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "core/constants.h"
#include "estimation/frequency_response/harmonics.h"

namespace hydroscope {
namespace {

using Complex = std::complex<double>;
constexpr double kRelativeFloor = 1e-6;  // of the gain: below it, rounding and not noise sets the error
constexpr int kMostBlocks = 16;
// Of the samples on the extreme, beyond what a sine's resolution explains.
constexpr double kRailShare = 0.03;
constexpr double kFewestOnRail = 5;         // samples on the extreme: a sine touches its top so often
constexpr std::size_t kFewestSamples = 20;  // fewer tell no rail from a sine
constexpr double kTransientShare = 0.4;     // of a hold, left out where nothing is known of the plant yet
// A block further from the mean of those behind it belongs to the transient.
constexpr double kTransientStd = 5;
constexpr double kResponseStd = 4;  // a response is one beyond so many standard deviations of its noise
// What may be left of the transient: a part of the noise, within shares of the response.
constexpr double kTransientOfNoise = 0.1, kLeastTransient = 1e-6, kMostTransient = 0.07;

/// Variance of the ratio (real and imaginary part together) if both residuals are white.
double WhiteVariance(const HeldSineSums::Fits& pair) {
  const double gain_squared = std::norm(pair.Ratio());
  return (pair.output.residual_variance + gain_squared * pair.input.residual_variance) /
         (static_cast<double>(pair.input.samples) * std::norm(pair.input.fundamental()));
}

/// Samples to leave out at the start of the hold before any look at the blocks.
double SettleSamples(const HeldSineSums& sums, const HeldSine& held, const SettleRule& settle) {
  const double hold = static_cast<double>(held.end - held.begin);
  if (settle.fixed >= 0) return settle.fixed;
  if (settle.time_constant < 0) return std::max(kTwoPi / held.omega, kTransientShare * hold);
  const auto middle = held.begin + static_cast<std::size_t>(kTransientShare * hold);
  const HeldSineSums::Fits pair = sums.Fit(middle, held.end);
  const double noise = std::sqrt(pair.output.residual_variance / static_cast<double>(pair.output.samples));
  const double share = std::clamp(kTransientOfNoise * noise / std::abs(pair.output.fundamental()),
                                  kLeastTransient, kMostTransient);
  return std::max(0.0, settle.dead_time) + settle.time_constant * std::log(1 / share) + 1;
}

struct Window {
  std::size_t begin = 0, end = 0;
  double periods = 0;
  bool valid() const { return periods >= 2; }
};

/// The largest number of whole periods that ends with the hold.
Window WholePeriods(const HeldSine& held, double earliest) {
  const double period = kTwoPi / held.omega;
  const double available =
      static_cast<double>(held.end) - std::max(earliest, static_cast<double>(held.begin));
  Window window;
  window.periods = std::floor((available + 0.5) / period);
  const auto length = static_cast<std::size_t>(std::max(0.0, std::round(window.periods * period)));
  window.end = held.end;
  window.begin = held.end - std::min(length, held.end - held.begin);
  if (HarmonicsFor(held.omega, window.end - window.begin) == 0) window.periods = 0;
  return window;
}

/// Borders of blocks of equally many whole periods, counted from the window's start.
std::vector<std::size_t> BlockBorders(const Window& window, double omega) {
  const double period = kTwoPi / omega;
  double per_block = std::max(1.0, std::floor(window.periods / kMostBlocks));
  while (HarmonicsFor(omega, static_cast<std::size_t>(per_block * period)) < HarmonicsFor(omega, 1'000'000) &&
         per_block * 4 < window.periods) {
    ++per_block;
  }
  const int blocks = static_cast<int>(window.periods / per_block);
  std::vector<std::size_t> borders;
  for (int b = 0; b <= blocks; ++b) {
    const auto border = window.begin + static_cast<std::size_t>(std::lround(b * per_block * period));
    borders.push_back(std::min(border, window.end));
  }
  return borders;
}

std::vector<Complex> BlockRatios(const HeldSineSums& sums, double omega,
                                 const std::vector<std::size_t>& borders) {
  std::vector<Complex> ratios;
  for (std::size_t b = 0; b + 1 < borders.size(); ++b) {
    if (HarmonicsFor(omega, borders[b + 1] - borders[b]) == 0) return {};
    ratios.push_back(sums.Fit(borders[b], borders[b + 1]).Ratio());
  }
  return ratios;
}

/// Sum of squared deviations from the mean over the number of degrees of freedom (both components together).
double Scatter(std::span<const Complex> values, Complex& mean) {
  mean = std::accumulate(values.begin(), values.end(), Complex(0)) / static_cast<double>(values.size());
  double sum = 0;
  for (const Complex& v : values) sum += std::norm(v - mean);
  return sum / static_cast<double>(values.size() - 1);
}

/// Number of blocks at the start that still belong to the transient.
std::size_t TransientBlocks(const std::vector<Complex>& ratios) {
  std::size_t first = 0;
  while (ratios.size() - first >= 6 && first < ratios.size() / 2) {
    Complex mean;
    const std::span<const Complex> rest = std::span(ratios).subspan(first + 1);
    const double scatter = std::max(Scatter(rest, mean), std::norm(kRelativeFloor * mean));
    if (std::norm(ratios[first] - mean) <= kTransientStd * kTransientStd * scatter) break;
    ++first;
  }
  return first;
}

PointReason Judge(const SignalRun& run, const Window& window, const FrequencyPoint& point) {
  const std::size_t samples = window.end - window.begin;
  if (LooksClipped(std::span(run.input).subspan(window.begin, samples)) ||
      LooksClipped(std::span(run.output).subspan(window.begin, samples))) {
    return PointReason::kClipped;
  }
  if (std::abs(point.response) < kResponseStd * std::sqrt(point.variance)) return PointReason::kNoResponse;
  return PointReason::kUsed;
}

/// Solves trigamma(x) = y for x > 0 by bisection in log x (trigamma falls monotonically).
double InverseTrigamma(double y) {
  double low = 1e-3, high = 1e6;
  for (int i = 0; i < 80; ++i) {
    const double middle = std::sqrt(low * high);
    (boost::math::trigamma(middle) > y ? low : high) = middle;
  }
  return std::sqrt(low * high);
}

}  // namespace

bool LooksClipped(std::span<const double> signal) {
  if (signal.size() < kFewestSamples) return false;
  const Eigen::Map<const Eigen::ArrayXd> values(signal.data(), static_cast<Eigen::Index>(signal.size()));
  const double low = values.minCoeff(), high = values.maxCoeff();
  const double amplitude = (high - low) / 2;
  if (!(amplitude > 0)) return true;
  const auto at_low = (values == low).count(), at_high = (values == high).count();
  const double at_rail = static_cast<double>(std::max(at_low, at_high));
  const double samples = static_cast<double>(signal.size());
  if (at_rail <= std::max(kRailShare * samples, kFewestOnRail)) return false;
  double resolution = 2 * amplitude;
  for (std::size_t n = 1; n < signal.size(); ++n) {
    if (signal[n] != signal[n - 1]) resolution = std::min(resolution, std::abs(signal[n] - signal[n - 1]));
  }
  // A sine spends acos(1 - q/A)/pi of its period within q of its top; a square wave of two values is no sine.
  const double expected = std::acos(std::max(-1.0, 1 - resolution / amplitude)) / std::numbers::pi;
  return at_rail > (2 * expected + kRailShare) * samples;
}

CorrelatedPoint CorrelateHeldSine(const SignalRun& run, double sample_period, const HeldSine& held,
                                  const HeldSineSums& sums, const SettleRule& settle) {
  CorrelatedPoint result;
  FrequencyPoint& point = result.point;
  point.frequency = held.omega / (kTwoPi * sample_period);
  point.amplitude = held.amplitude;
  point.reason = PointReason::kTooShort;
  const auto time_of = [&](std::size_t n) { return run.start + static_cast<double>(n) * sample_period; };
  point.begin = time_of(held.begin);
  point.end = time_of(held.end);

  Window window = WholePeriods(held, static_cast<double>(held.begin) + SettleSamples(sums, held, settle));
  if (!window.valid()) return result;
  std::vector<std::size_t> borders = BlockBorders(window, held.omega);
  std::vector<Complex> ratios = BlockRatios(sums, held.omega, borders);
  if (ratios.size() < 2) return result;
  if (const std::size_t transient = settle.fixed < 0 ? TransientBlocks(ratios) : 0; transient > 0) {
    window = WholePeriods(held, static_cast<double>(borders[transient]));
    borders = BlockBorders(window, held.omega);
    ratios = BlockRatios(sums, held.omega, borders);
    if (!window.valid() || ratios.size() < 2) return result;
  }

  const HeldSineSums::Fits pair = sums.Fit(window.begin, window.end);
  point.response = pair.Ratio();
  point.amplitude = 2 * std::abs(pair.input.fundamental());
  point.output_amplitude = 2 * std::abs(pair.output.fundamental());
  point.input_distortion = pair.input.Distortion();
  point.output_distortion = pair.output.Distortion();
  point.distortion_std = pair.output.DistortionStd();
  point.coherence = 1 / (1 + pair.output.residual_variance / (2 * std::norm(pair.output.fundamental())));
  point.begin = time_of(window.begin);
  point.end = time_of(window.end);
  point.dropped = static_cast<double>(window.begin - held.begin) * sample_period;
  point.periods = window.periods;

  Complex mean;
  const double blocks = static_cast<double>(ratios.size());
  const double floor = std::norm(kRelativeFloor * point.response);
  point.variance = std::max(Scatter(ratios, mean) / blocks / 2, floor);
  point.dof = 2 * (blocks - 1);
  result.white_variance = std::max(WhiteVariance(pair) / 2, floor);
  point.reason = Judge(run, window, point);
  return result;
}

void PoolVariances(std::vector<CorrelatedPoint>& points) {
  // log(block / white) of each point, freed of the bias of the logarithm of a chi-square.
  std::vector<double> ratio, spread;
  for (const CorrelatedPoint& p : points) {
    if (p.point.reason == PointReason::kTooShort) continue;
    const double half = p.point.dof / 2;
    ratio.push_back(std::log(p.point.variance / p.white_variance) - boost::math::digamma(half) +
                    std::log(half));
    spread.push_back(boost::math::trigamma(half));
  }
  const double count = static_cast<double>(ratio.size());
  if (count < 3) return;
  double weight = 0, mean = 0;
  for (std::size_t i = 0; i < ratio.size(); ++i) {
    weight += 1 / spread[i];
    mean += ratio[i] / spread[i];
  }
  mean /= weight;
  double excess = 0;
  for (std::size_t i = 0; i < ratio.size(); ++i) {
    excess += ((ratio[i] - mean) * (ratio[i] - mean) * count / (count - 1) - spread[i]) / count;
  }
  constexpr double kLeastExcess = 1e-6;  // below it the variances are all alike, and more degrees say nothing
  const double prior_dof =
      excess > kLeastExcess ? 2 * InverseTrigamma(excess) : std::numeric_limits<double>::infinity();
  for (CorrelatedPoint& p : points) {
    if (p.point.reason == PointReason::kTooShort) continue;
    const double prior = p.white_variance * std::exp(mean);
    if (std::isinf(prior_dof)) {
      p.point.variance = prior;
    } else {
      p.point.variance = (prior_dof * prior + p.point.dof * p.point.variance) / (prior_dof + p.point.dof);
    }
    p.point.dof += std::isinf(prior_dof) ? 2 * weight : prior_dof;
  }
}

}  // namespace hydroscope
