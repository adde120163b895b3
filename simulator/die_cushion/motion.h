#pragma once

#include <array>
#include <cstdint>

#include "simulator/die_cushion/press_options.h"
#include "simulator/random.h"

namespace hydroscope {

enum class PressPhase { kDraw, kRestBottom, kReturn, kRestTop };

/// The cushion's prescribed way: drawn down by the ram at a constant speed of its own per stroke, rest, return, rest.
/// Speeds rise and fall as a raised cosine. Ask for times that do not decrease by more than one phase.
class RamMotion {
 public:
  RamMotion(const PressMotion& motion, std::uint64_t seed);

  struct Point {
    double z = 0;  ///< m
    double v = 0;  ///< m/s, negative while drawing
  };
  /// Position and speed at `t`, s.
  Point At(double t);

  /// Phase reached by the latest question.
  PressPhase phase() const { return phase_.kind; }
  std::int64_t stroke() const { return stroke_; }
  double phase_begin() const { return phase_.begin; }
  double phase_end() const { return phase_.begin + phase_.duration; }
  double cruise_speed() const { return phase_.speed; }  ///< m/s, signed

 private:
  struct Phase {
    PressPhase kind = PressPhase::kRestTop;
    double begin = 0, duration = 0;  ///< s
    double z = 0;                    ///< m at begin
    double speed = 0;                ///< m/s, signed
  };
  void NextPhase();
  Point InPhase(const Phase& phase, double t) const;

  PressMotion motion_;
  RandomStream random_;
  Phase phase_, before_;
  std::int64_t stroke_ = -1;
};

}  // namespace hydroscope
