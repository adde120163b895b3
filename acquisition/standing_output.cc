#include "acquisition/standing_output.h"

#include <algorithm>
#include <cmath>

#include "models/closed_loop.h"

namespace hydroscope {
namespace {

constexpr std::size_t kRowsToStand = 20;  ///< over which a reading must repeat, however short `stuck_time`
constexpr std::size_t kRowsBack = 1000;   ///< that turn out to stand afterwards
/// Smallest steps of the output that its set point goes through: what is faster than the loop it follows by a share.
constexpr double kStepsOfOutput = 10;

}  // namespace

std::optional<StandingOutput> StandingOutput::For(const Machine& machine, double sample_period) {
  if (ClosedLoopOf(machine) == nullptr) return std::nullopt;
  const std::vector<int> signals = SignalsOfLoop(machine);
  if (signals.front() < 0 || signals.back() < 0) return std::nullopt;
  StandingOutput out;
  out.set_point_ = static_cast<std::size_t>(signals.front());
  out.output_ = static_cast<std::size_t>(signals.back());
  const double stuck_time = machine.signals[out.output_].stuck_time;
  if (!(stuck_time > 0) || !(sample_period > 0)) return std::nullopt;
  out.least_ = std::max(kRowsToStand, static_cast<std::size_t>(stuck_time / sample_period));
  return out;
}

std::size_t StandingOutput::reach() const { return std::min(least_ + 1, kRowsBack); }

void StandingOutput::Judge(SampleBlock& block) {
  before_ = 0;
  for (std::size_t row = 0; row < block.rows(); ++row) {
    const double reading = block.signal[output_][row], set = block.signal[set_point_][row];
    if (!begun_ || reading != last_) {
      if (const double step = std::abs(reading - last_); begun_ && step > 0)
        step_ = step_ == 0 ? step : std::min(step_, step);
      begun_ = std::isfinite(reading);
      last_ = reading;
      at_ = low_ = high_ = set;
      moving_ = 0;
      stands_ = false;
      continue;
    }
    low_ = std::fmin(low_, set);
    high_ = std::fmax(high_, set);
    if (moving_ > 0 || set != at_) ++moving_;
    if (stands_) {
      block.quality[output_][row] |= quality::kStuck;
    } else if (moving_ > least_ && high_ - low_ > kStepsOfOutput * step_) {
      stands_ = true;
      const std::size_t back = std::min(moving_, reach());
      for (std::size_t k = 0; k < std::min(back, row + 1); ++k)
        block.quality[output_][row - k] |= quality::kStuck;
      before_ += back > row + 1 ? back - row - 1 : 0;
    }
  }
}

}  // namespace hydroscope
