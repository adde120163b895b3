#include "simulator/die_cushion/controller.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace hydroscope {
namespace {

constexpr double kSetPointLag = 0.030;  // s
constexpr double kFilterLag = 0.004;    // s, of the measured pressure
constexpr double kBandwidth = 25;       // rad/s, of the proportional part
constexpr double kReset = 6;            // 1/s, integral over proportional part
constexpr double kMaxIntegral = 0.15;   // 1, of the spool
constexpr double kUsableOpening = 0.8;  // 1, set points are chosen so that less is enough
constexpr double kKnownFlow = 0.95;     // the controller's nominal flow against the true one
constexpr double kFullScale = 10;       // V

}  // namespace

SetPoint::SetPoint(const PressMachine& machine, const PressMotion& motion, std::uint64_t seed)
    : machine_(machine),
      motion_(motion),
      random_(StreamSeed(seed, "set point")),
      smooth_(motion.rest_pressure) {}

void SetPoint::DrawLevel(double t, const RamMotion& ram) {
  const double conductance = machine_.Q_vn / std::sqrt(machine_.dp_nom);
  const double root = machine_.A_A * std::abs(ram.cruise_speed()) / (kUsableOpening * conductance);
  level_ = random_.Uniform(motion_.set_point_min, motion_.set_point_max);
  next_change_ = t + random_.Uniform(motion_.step_time_min, motion_.step_time_max);
  if (const std::size_t count = motion_.set_points.size(); count > 0) {
    const double part = (ram.phase_end() - ram.phase_begin()) / static_cast<double>(count);
    const auto index = static_cast<std::size_t>(std::max(0.0, (t - ram.phase_begin()) / part + 0.5));
    level_ = motion_.set_points[std::min(index, count - 1)];
    next_change_ = ram.phase_begin() + static_cast<double>(index + 1) * part;
  }
  level_ = std::max(level_, machine_.p_tank + root * root);
}

double SetPoint::At(double t, double period, const RamMotion& ram) {
  double target = motion_.rest_pressure;
  if (ram.phase() == PressPhase::kDraw) {
    if (ram.stroke() != stroke_) {
      stroke_ = ram.stroke();
      for (int k = 0; k < 2; ++k) {
        frequency_[k] = 2 * std::numbers::pi * random_.Uniform(0.4, 1.6);
        phase_[k] = 2 * std::numbers::pi * random_.Uniform();
      }
      DrawLevel(ram.phase_begin(), ram);
    } else if (t >= next_change_) {
      DrawLevel(next_change_, ram);
    }
    target = level_;
    for (int k = 0; k < 2; ++k) target += motion_.wander / 2 * std::sin(frequency_[k] * t + phase_[k]);
  }
  smooth_ += (target - smooth_) * (1 - std::exp(-period / kSetPointLag));
  return smooth_;
}

PressureController::PressureController(const PressMachine& machine, const PressMotion& motion, double period,
                                       std::uint64_t seed)
    : machine_(machine),
      dither_size_(motion.dither),
      period_(period),
      random_(StreamSeed(seed, "controller")),
      filtered_(motion.rest_pressure) {}

double PressureController::FeedForward(double set_point, double speed) const {
  const double conductance = kKnownFlow * machine_.Q_vn / std::sqrt(machine_.dp_nom);
  const double drop = speed < 0 ? set_point - machine_.p_tank : machine_.p_supply - set_point;
  return -machine_.A_A * speed / (conductance * std::sqrt(std::max(drop, 5e5)));
}

double PressureController::Command(double measured, double set_point, const RamMotion::Point& ram,
                                   PressPhase phase) {
  if (phase != phase_) integral_ = 0;
  phase_ = phase;
  filtered_ += (measured - filtered_) * (1 - std::exp(-period_ / kFilterLag));
  const double error = filtered_ - set_point;
  const double conductance = machine_.Q_vn / std::sqrt(machine_.dp_nom);
  const double drop = std::max(ram.v > 0 ? machine_.p_supply - set_point : set_point - machine_.p_tank, 5e5);
  const double proportional =
      kBandwidth * (machine_.V0 + machine_.A_A * ram.z) / (machine_.K * conductance * std::sqrt(drop));
  integral_ = std::clamp(integral_ + kReset * period_ * proportional * error, -kMaxIntegral, kMaxIntegral);
  dither_left_ -= period_;
  if (dither_left_ <= 0) {
    dither_ = random_.Uniform() < 0.5 ? -dither_size_ : dither_size_;
    dither_left_ = random_.Uniform(0.02, 0.15);
  }
  const double opening = FeedForward(set_point, ram.v) + proportional * error + integral_ + dither_;
  return std::clamp(kFullScale * opening / machine_.valve_gain, -kFullScale, kFullScale);
}

}  // namespace hydroscope
