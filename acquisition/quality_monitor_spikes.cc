#include <algorithm>
#include <bit>
#include <cmath>

#include "acquisition/quality_monitor.h"
#include "core/constants.h"

namespace hydroscope {
namespace {

constexpr Quality kBreaks =
    quality::kMissing | quality::kGap | quality::kTimeBackwards | quality::kClockJump | quality::kDuplicate;

}  // namespace

/// Standard deviation of the noise.
double QualityMonitor::Sigma(const Track& track) {
  return std::max(track.scale / kMedianThirdDifference, track.known_noise);
}

/// A step between two readings that noise does not make.
double QualityMonitor::LeastStep(const Track& track) { return kSpikeStd * Sigma(track); }

/// Twice the distance to the mean of both neighbours that noise does not make.
double QualityMonitor::LeastSpike(const Track& track) { return kSpikeStd * kTwiceDistanceStd * Sigma(track); }

void QualityMonitor::FlagSpikes(const double* x, std::size_t rows, const Track& track, Quality* flags) {
  const double least = LeastSpike(track);
  for (std::size_t i = 0; i < rows; ++i) {
    const double* v = x + i;
    const double distance = 0.5 * std::abs((v[1] - v[0]) - (v[0] - v[-1]));
    if (!(2.0 * distance > least)) continue;
    const bool neighbours_agree = kSpikeOverNeighbours * std::abs(v[1] - v[-1]) <= distance;
    const bool quiet_before = kSpikeOverNeighbours * std::abs(v[-1] - v[-2]) <= distance;
    const bool quiet_after = kSpikeOverNeighbours * std::abs(v[2] - v[1]) <= distance;
    const bool unbroken = ((flags[i] | flags[i + 1] | flags[i + 2]) & kBreaks) == 0;
    if (neighbours_agree && quiet_before && quiet_after && unbroken) flags[i] |= quality::kSpike;
  }
}

/// Readings that step away together and, at most kLongestPulse rows later, back to where they were, both times as far as a
/// spike; of the very same reading they are a filled gap. The row behind them is a candidate by itself (Count), so that it
/// makes no difference what else is looked at with it.
void QualityMonitor::FlagPulses(const double* x, std::size_t rows, const Track& track, Quality* flags) {
  if (!track.settled || track.is_marker) return;
  const double least = LeastSpike(track);
  for (std::size_t i = 0; i < rows; ++i) {
    const double* after = x + i;
    const double out = after[0] - after[-1], bend = (after[1] - after[0]) - out;
    if (!(std::abs(out) > least && bend * bend > least * least)) continue;
    for (std::size_t run = 2; run <= kLongestPulse && after - run - kHistory >= column_.data(); ++run) {
      const double* first = after - run;
      const double in = first[0] - first[-1], step = std::min(std::abs(in), std::abs(out));
      const auto is_quiet = [step](double a, double b) {
        return kSpikeOverNeighbours * std::abs(a - b) <= step;
      };
      const bool held = std::all_of(first, after, [first](double inside) { return inside == *first; });
      bool pulse = !held && in * out < 0 && step > least && is_quiet(after[0], first[-1]) &&
                   is_quiet(first[-1], first[-2]) && is_quiet(after[1], after[0]);
      for (const double* inside = first + 1; pulse && inside < after; ++inside)
        pulse = is_quiet(inside[0], inside[-1]);
      if (pulse) FlagBack(flags + i, static_cast<std::int64_t>(run), quality::kSpike);
    }
  }
}

/// Rows since the oldest step that a pulse may have begun with which cannot be judged yet. Steps count from less than half
/// of what FlagPulses asks for: the scale may fall a little until it does. Of many rows at once, in which it may fall far,
/// as many are held as a pulse may last.
std::size_t QualityMonitor::PulseUnderWay(const SampleBlock& block) {
  constexpr unsigned kLooked = (1U << (kLongestPulse + kAhead)) - 1;  // steps into that many rows
  std::size_t longest = 0;
  for (std::size_t channel = 0; channel < tracks_.size(); ++channel) {
    Track& track = tracks_[channel];
    const std::vector<double>& x = block.signal[channel];
    const double least = block.rows() > kFrame ? -1 : track.scale > 0 ? LeastStep(track) : kInfinity;
    for (std::size_t k = x.size() - std::min<std::size_t>(x.size(), std::bit_width(kLooked)); k < x.size();
         ++k) {
      const double before = k > 0 ? x[k - 1] : track.last;
      track.steps = (track.steps << 1 | unsigned(std::abs(x[k] - before) > least)) & kLooked;
    }
    longest = std::max<std::size_t>(longest, std::bit_width(track.steps));
  }
  return longest - std::min(longest, kAhead);
}

}  // namespace hydroscope
