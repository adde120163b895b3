#include "estimation/frequency_response/segments.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>

#include "core/constants.h"
#include "core/quantile.h"
#include "estimation/frequency_response/harmonics.h"

namespace hydroscope {
namespace {

using Complex = std::complex<double>;
constexpr double kLineTolerance = 0.06;    // of a period: crossing against the line through the ones before
constexpr double kPhasorTolerance = 0.02;  // of the amplitude: scatter of block phasors of a steady sine
constexpr double kSettledPhase = 1e-7;  // rad over a stretch, by which a better frequency no longer matters
constexpr int kFewestPeriods = 3;
constexpr std::size_t kGuardSamples = 2;  // a change that starts within the tolerance shows a little late

/// What a crossing and a held sine are. The frequencies and figures that come of it are checked on simulated sweeps of varied
/// noise, sampling and amplitude by `hydroscope benchmark frf`.
struct HeldSineOptions {
  double hysteresis = 0.25;      ///< of the amplitude that the signal has at the time ...
  double least_amplitude = 0.1;  ///< ... which counts as at least so much of that of the whole log
  double shortest_decay = 4;     ///< samples in which that amplitude is forgotten at least
  double most_blocks = 24;       ///< of periods, into which a stretch is cut
  double least_block = 9;        ///< samples of a block: a phasor of fewer is noise
  double most_noise = 0.5;       ///< of the rms of a sine, beside which it still counts as one
  double significance = 3;       ///< standard deviations by which phasors may scatter from noise alone
  double line_samples = 0.3;     ///< that a crossing may lie off the line for its sampling alone
  double jump_leaves = 0.15;     ///< of the scatter of phasors: more, and no jump explains it
  double top = 0.98;  ///< quantile of the command's magnitude that is its amplitude: spikes are rarer
  double highest_omega = 0.8 * std::numbers::pi;  ///< rad per sample: beyond, too near half the sampling rate
};
constexpr HeldSineOptions kHeldSine{};

/// Times (in samples) of upward crossings through `centre`. A crossing counts when the signal goes from below
/// -h to above +h; its time is the middle between the first and last passage through zero on the way.
std::vector<double> UpwardCrossings(std::span<const double> signal, double centre, double amplitude) {
  std::vector<double> crossings;
  double peak = 0, decay_time = static_cast<double>(signal.size()) / 4;
  bool low = false;
  double first = -1, last = -1;
  for (std::size_t n = 1; n < signal.size(); ++n) {
    const double v = signal[n] - centre, before = signal[n - 1] - centre;
    peak = std::max(std::abs(v), peak * (1 - 1 / decay_time));
    const double hysteresis = kHeldSine.hysteresis * std::max(peak, kHeldSine.least_amplitude * amplitude);
    if (v < -hysteresis) {
      low = true;
      first = last = -1;
    }
    if (low && before <= 0 && v > 0) {
      last = static_cast<double>(n - 1) + before / (before - v);
      if (first < 0) first = last;
    }
    if (low && last >= 0 && v > hysteresis) {
      const double crossing = (first + last) / 2;
      if (!crossings.empty())
        decay_time = std::max(kHeldSine.shortest_decay, 2 * (crossing - crossings.back()));
      crossings.push_back(crossing);
      low = false;
    }
  }
  return crossings;
}

/// Straight line through (0, t_0), (1, t_1), ... that grows by one point at a time.
class GrowingLine {
 public:
  void Add(double t) {
    const double k = count_++;
    k_ += k;
    kk_ += k * k;
    t_ += t;
    kt_ += k * t;
  }
  double Slope() const { return (count_ * kt_ - k_ * t_) / (count_ * kk_ - k_ * k_); }
  double Predict() const { return (t_ - Slope() * k_) / count_ + Slope() * count_; }
  int count() const { return static_cast<int>(count_); }

 private:
  double count_ = 0, k_ = 0, kk_ = 0, t_ = 0, kt_ = 0;
};

struct HeldFrequency {
  double begin, end, period;  // samples
};

std::vector<HeldFrequency> HeldFrequencies(const std::vector<double>& crossings) {
  std::vector<HeldFrequency> held;
  std::size_t i = 0;
  while (i + kFewestPeriods - 1 < crossings.size()) {
    GrowingLine line;
    line.Add(crossings[i]);
    line.Add(crossings[i + 1]);
    std::size_t j = i + 2;
    for (; j < crossings.size(); ++j) {
      const double tolerance = kLineTolerance * line.Slope() + kHeldSine.line_samples;
      if (std::abs(crossings[j] - line.Predict()) > tolerance) break;
      line.Add(crossings[j]);
    }
    if (line.count() >= kFewestPeriods) {
      held.push_back({crossings[i], crossings[j - 1], line.Slope()});
      i = j;
    } else {
      ++i;
    }
  }
  return held;
}

/// Phasors of consecutive blocks of whole periods, against exp(i omega n) with n counted from the signal's start.
struct Blocks {
  std::vector<Complex> phasor;
  std::vector<double> centre;       // samples
  std::vector<std::size_t> border;  // block b is [border b, border b+1)
  double noise_variance = 0;        // of the signal about the blocks' sines
};

Blocks BlockPhasors(std::span<const double> signal, std::size_t begin, std::size_t end, double omega) {
  const double period = kTwoPi / omega;
  const double periods = std::floor((static_cast<double>(end - begin) + 0.5) / period);
  double per_block = std::max(1.0, std::ceil(periods / kHeldSine.most_blocks));
  while (per_block * period < kHeldSine.least_block && per_block < periods) ++per_block;
  Blocks blocks;
  blocks.border.push_back(begin);
  for (double b = 1; b * per_block <= periods; ++b) {
    const auto stop = std::min(end, begin + static_cast<std::size_t>(std::lround(b * per_block * period)));
    const std::size_t start = blocks.border.back();
    const int harmonics = HarmonicsFor(omega, stop - start);
    if (harmonics == 0) break;
    const auto fit = FitHarmonics(signal.subspan(start, stop - start), omega,
                                  omega * static_cast<double>(start), harmonics);
    blocks.phasor.push_back(fit.fundamental());
    blocks.centre.push_back(0.5 * static_cast<double>(start + stop - 1));
    blocks.border.push_back(stop);
    blocks.noise_variance += fit.residual_variance;
  }
  if (!blocks.phasor.empty()) blocks.noise_variance /= static_cast<double>(blocks.phasor.size());
  return blocks;
}

/// Slope of the blocks' phases over time, rad per sample; phases are unwrapped from block to block.
double PhaseSlope(const Blocks& blocks) {
  const std::size_t count = blocks.phasor.size();
  std::vector<double> phase(count, std::arg(blocks.phasor[0]));
  for (std::size_t b = 1; b < count; ++b) {
    phase[b] = phase[b - 1] + std::arg(blocks.phasor[b] / blocks.phasor[b - 1]);
  }
  const double n = static_cast<double>(count);
  const double mean_t = std::accumulate(blocks.centre.begin(), blocks.centre.end(), 0.0) / n;
  const double mean_p = std::accumulate(phase.begin(), phase.end(), 0.0) / n;
  double tt = 0, tp = 0;
  for (std::size_t b = 0; b < count; ++b) {
    tt += (blocks.centre[b] - mean_t) * (blocks.centre[b] - mean_t);
    tp += (blocks.centre[b] - mean_t) * (phase[b] - mean_p);
  }
  return tp / tt;
}

double SquaresAboutMean(std::span<const Complex> values) {
  const Complex mean =
      std::accumulate(values.begin(), values.end(), Complex(0)) / static_cast<double>(values.size());
  double sum = 0;
  for (const Complex& v : values) sum += std::norm(v - mean);
  return sum;
}

bool Steady(const Blocks& blocks) {
  const double count = static_cast<double>(blocks.phasor.size());
  const Complex mean = std::accumulate(blocks.phasor.begin(), blocks.phasor.end(), Complex(0)) / count;
  const double scatter = std::sqrt(SquaresAboutMean(blocks.phasor) / count);
  const double samples = static_cast<double>(blocks.border[1] - blocks.border[0]);
  const double from_noise = std::sqrt(blocks.noise_variance / samples);
  const double signal_rms = std::sqrt(2.0) * std::abs(mean);
  if (std::sqrt(blocks.noise_variance) > kHeldSine.most_noise * signal_rms) return false;
  return scatter <= std::max(kPhasorTolerance * std::abs(mean), kHeldSine.significance * from_noise);
}

/// The block border that best parts the phasors into two steady groups, if that explains nearly all scatter.
std::optional<std::size_t> FindJump(const Blocks& blocks) {
  const std::span<const Complex> all(blocks.phasor);
  const double total = SquaresAboutMean(all);
  double best = kHeldSine.jump_leaves * total;
  std::optional<std::size_t> jump;
  for (std::size_t b = 2; b + 2 < all.size(); ++b) {  // block b itself may hold the jump: left out
    const double rest = SquaresAboutMean(all.first(b)) + SquaresAboutMean(all.subspan(b + 1));
    if (rest < best) {
      best = rest;
      jump = b;
    }
  }
  return jump;
}

/// Crossings near a change of frequency may still lie on the line: estimate from the inside, then move the
/// edges out while the sine predicts the command, at most one and a half periods beyond where they were.
void SetEdges(std::span<const double> signal, HeldSine& held) {
  const double period = kTwoPi / held.omega;
  const auto reach = static_cast<std::size_t>(1.5 * period);
  const std::size_t earliest = held.begin > reach ? held.begin - reach : 0;
  const std::size_t latest = std::min(signal.size(), held.end + reach);
  const auto trim = static_cast<std::size_t>(std::ceil(period));
  if (static_cast<double>(held.end - held.begin) > 5 * period) {
    held.begin += trim;
    held.end -= trim;
  }
  const auto fit = FitHarmonics(signal.subspan(held.begin, held.end - held.begin), held.omega,
                                held.omega * static_cast<double>(held.begin),
                                HarmonicsFor(held.omega, held.end - held.begin));
  held.amplitude = 2 * std::abs(fit.fundamental());
  held.noise = std::sqrt(fit.residual_variance);
  const double tolerance = std::max(5 * held.noise, 1e-3 * held.amplitude);
  const auto predicted = [&](std::size_t n) {
    double value = fit.coefficients[0].real();
    for (int k = 1; k <= fit.harmonics; ++k) {
      const double angle = static_cast<double>(k) * held.omega * static_cast<double>(n);
      value += 2 * (fit.coefficients[k] * std::polar(1.0, angle)).real();
    }
    return std::abs(signal[n] - value) <= tolerance;
  };
  while (held.begin > earliest && predicted(held.begin - 1)) --held.begin;
  while (held.end < latest && predicted(held.end)) ++held.end;
  if (held.end < signal.size()) held.end -= kGuardSamples;
}

void Examine(std::span<const double> signal, std::size_t begin, std::size_t end, double omega, int depth,
             HeldSines& result) {
  const double fewest = (kFewestPeriods - 1) * kTwoPi / omega;
  if (end <= begin || static_cast<double>(end - begin) < fewest - 1) return;
  const auto period = static_cast<std::size_t>(std::ceil(kTwoPi / omega));
  const bool long_enough = end - begin > 5 * period;  // then judge without the first and last period
  const std::size_t first = long_enough ? begin + period : begin, last = long_enough ? end - period : end;
  Blocks blocks = BlockPhasors(signal, first, last, omega);
  if (blocks.phasor.size() < 2) return;
  for (int pass = 0; pass < 3; ++pass) {
    const double slope = PhaseSlope(blocks);
    omega += slope;
    if (!(omega > 0) || omega > kHeldSine.highest_omega) return;
    if (std::abs(slope) * static_cast<double>(last - first) < kSettledPhase) break;
    blocks = BlockPhasors(signal, first, last, omega);
    if (blocks.phasor.size() < 2) return;
  }
  if (Steady(blocks)) {
    HeldSine held{begin, end, omega, 0, 0};
    SetEdges(signal, held);
    result.found.push_back(held);
    return;
  }
  const auto jump = depth < 8 ? FindJump(blocks) : std::nullopt;
  if (!jump) {
    ++result.unsteady;
    return;
  }
  Examine(signal, begin, blocks.border[*jump], omega, depth + 1, result);
  Examine(signal, blocks.border[*jump + 1], end, omega, depth + 1, result);
}

/// Neighbours must not share samples: the later one, whose transient is dropped anyway, gives way.
void PartOverlaps(std::vector<HeldSine>& found) {
  for (std::size_t i = 1; i < found.size(); ++i) found[i].begin = std::max(found[i].begin, found[i - 1].end);
  std::erase_if(found, [](const HeldSine& held) { return held.begin >= held.end; });
}

/// A command that its controller refreshes every few samples only: crossings of the stairs scatter, those of
/// one sample per stair do not.
struct Stairs {
  std::size_t length = 1;  // samples per stair; 1: none
  std::size_t first = 0;   // sample at which a stair begins
};

Stairs FindStairs(std::span<const double> command) {
  constexpr std::size_t kLongest = 64;
  std::vector<std::size_t> distances(kLongest + 1, 0);
  std::size_t last = 0, changes = 0;
  for (std::size_t n = 1; n < command.size(); ++n) {
    if (command[n] == command[n - 1]) continue;
    if (changes++ > 0 && n - last <= kLongest) ++distances[n - last];
    last = n;
  }
  Stairs stairs;
  stairs.length = static_cast<std::size_t>(std::ranges::max_element(distances) - distances.begin());
  if (stairs.length < 2) return {};
  std::vector<std::size_t> at(stairs.length, 0);
  for (std::size_t n = 1; n < command.size(); ++n) at[n % stairs.length] += command[n] != command[n - 1];
  stairs.first = static_cast<std::size_t>(std::ranges::max_element(at) - at.begin());
  return 10 * at[stairs.first] >= 9 * changes ? stairs : Stairs{};
}

HeldSines FindInSmooth(std::span<const double> command) {
  HeldSines result;
  if (command.size() < 8) return result;
  const double centre = Quantile({command.begin(), command.end()}, 0.5, 0);
  std::vector<double> magnitude(command.size());
  std::transform(command.begin(), command.end(), magnitude.begin(),
                 [centre](double u) { return std::abs(u - centre); });
  const double amplitude = Quantile(magnitude, kHeldSine.top, 0);
  if (!(amplitude > 0)) return result;

  const std::vector<double> crossings = UpwardCrossings(command, centre, amplitude);
  if (crossings.size() >= 2) result.active = static_cast<std::size_t>(crossings.back() - crossings.front());
  for (const HeldFrequency& stretch : HeldFrequencies(crossings)) {
    Examine(command, static_cast<std::size_t>(std::ceil(stretch.begin)),
            static_cast<std::size_t>(stretch.end), kTwoPi / stretch.period, 0, result);
  }
  PartOverlaps(result.found);
  for (const HeldSine& held : result.found) result.covered += held.end - held.begin;
  return result;
}

}  // namespace

HeldSines FindHeldSines(std::span<const double> command) {
  const Stairs stairs = FindStairs(command);
  if (stairs.length == 1) return FindInSmooth(command);
  std::vector<double> one_each;
  for (std::size_t n = stairs.first; n < command.size(); n += stairs.length) one_each.push_back(command[n]);
  HeldSines result = FindInSmooth(one_each);
  for (HeldSine& held : result.found) {
    held.begin = stairs.first + held.begin * stairs.length;
    held.end = std::min(command.size(), stairs.first + held.end * stairs.length);
    held.omega /= static_cast<double>(stairs.length);
  }
  result.stair_length = stairs.length;
  result.active *= stairs.length;
  result.covered *= stairs.length;
  return result;
}

}  // namespace hydroscope
