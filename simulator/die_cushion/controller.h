#pragma once

#include <cstdint>

#include "simulator/die_cushion/motion.h"
#include "simulator/die_cushion/press_options.h"
#include "simulator/random.h"

namespace hydroscope {

/// Pressure set point: random steps while drawing with a slow variation, the rest pressure otherwise, rounded
/// by a first-order lag. Levels that the valve could not hold at the ram speed are raised to one that it can.
class SetPoint {
 public:
  SetPoint(const PressMachine& machine, const PressMotion& motion, std::uint64_t seed);
  /// Set point at `t`, s; `period` s since the question before.
  double At(double t, double period, const RamMotion& ram);

 private:
  void DrawLevel(double t, const RamMotion& ram);

  PressMachine machine_;
  PressMotion motion_;
  RandomStream random_;
  std::int64_t stroke_ = -1;
  double level_ = 0, next_change_ = 0;
  double frequency_[2] = {}, phase_[2] = {};
  double smooth_;
};

/// Discrete pressure controller: feed-forward of the flow that the ram displaces (known nominal data only),
/// and a proportional-integral part on the measured pressure behind a first-order filter.
class PressureController {
 public:
  PressureController(const PressMachine& machine, const PressMotion& motion, double period,
                     std::uint64_t seed);

  /// Valve command, V (-10...10), from the measured pressure, the set point and the state of the ram.
  double Command(double measured, double set_point, const RamMotion::Point& ram, PressPhase phase);

 private:
  double FeedForward(double set_point, double speed) const;

  PressMachine machine_;
  double dither_size_, period_;
  RandomStream random_;
  double filtered_, integral_ = 0;
  double dither_ = 0, dither_left_ = 0;
  PressPhase phase_ = PressPhase::kDraw;
};

}  // namespace hydroscope
