#include "simulator/die_cushion/motion.h"

#include <cmath>
#include <numbers>

namespace hydroscope {

RamMotion::RamMotion(const PressMotion& motion, std::uint64_t seed)
    : motion_(motion), random_(StreamSeed(seed, "ram motion")) {
  phase_.z = motion.z_top;
  NextPhase();
  before_ = phase_;
}

RamMotion::Point RamMotion::At(double t) {
  while (t >= phase_end()) {
    before_ = phase_;
    NextPhase();
  }
  return InPhase(t < phase_.begin ? before_ : phase_, t);
}

RamMotion::Point RamMotion::InPhase(const Phase& phase, double t) const {
  if (phase.speed == 0) return {phase.z, 0};
  constexpr double kPi = std::numbers::pi;
  const double ramp = motion_.ramp_time, since = t - phase.begin, left = phase.begin + phase.duration - t;
  const auto ramp_way = [&](double s) {
    return phase.speed * (s / 2 - ramp / (2 * kPi) * std::sin(kPi * s / ramp));
  };
  const auto ramp_speed = [&](double s) { return phase.speed * (1 - std::cos(kPi * s / ramp)) / 2; };
  if (since < ramp) return {phase.z + ramp_way(since), ramp_speed(since)};
  const double way = phase.speed * (phase.duration - ramp);
  if (left < ramp) return {phase.z + way - ramp_way(left), ramp_speed(left)};
  return {phase.z + phase.speed * (since - ramp / 2), phase.speed};
}

void RamMotion::NextPhase() {
  const Phase last = phase_;
  phase_.begin = last.begin + last.duration;
  phase_.z = InPhase(last, phase_.begin).z;
  const auto move = [&](PressPhase kind, double target, double speed) {
    phase_.kind = kind;
    phase_.speed = std::copysign(speed, target - phase_.z);
    phase_.duration = std::abs(target - phase_.z) / speed + motion_.ramp_time;
  };
  const auto rest = [&](PressPhase kind) {
    phase_.kind = kind;
    phase_.speed = 0;
    phase_.duration = random_.Uniform(motion_.dwell_min, motion_.dwell_max);
  };
  switch (last.kind) {
    case PressPhase::kRestTop: {
      ++stroke_;
      const double bottom = motion_.z_bottom + random_.Uniform(-1, 1) * motion_.z_bottom_spread;
      const double random_speed = random_.Uniform(motion_.speed_min, motion_.speed_max);
      move(PressPhase::kDraw, bottom,
           motion_.speeds.empty()
               ? random_speed
               : motion_.speeds[static_cast<std::size_t>(stroke_) % motion_.speeds.size()]);
      break;
    }
    case PressPhase::kDraw:
      rest(PressPhase::kRestBottom);
      break;
    case PressPhase::kRestBottom:
      move(PressPhase::kReturn, motion_.z_top, motion_.return_speed);
      break;
    case PressPhase::kReturn:
      rest(PressPhase::kRestTop);
      break;
  }
}

}  // namespace hydroscope
