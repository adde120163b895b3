#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "simulator/manipulator/machine.h"

namespace hydroscope {

/// Where the tip should be, m and m/s in the base frame.
struct TipReference {
  TipPosition position, speed;
};

/// A joint angle as a finite Fourier series about a centre.
struct JointSeries {
  double centre = 0;  ///< rad
  struct Term {
    double sine = 0, cosine = 0;  ///< rad
  };
  std::vector<Term> terms;  ///< of multiples of the base frequency
};

/// What the arm is asked to do.
struct ManipulatorMotion {
  enum class Kind {
    kParallelogram,  ///< the paper's path: 2 m high, 1 m wide, quintic polynomials of 3 s from corner to corner
    kSeries,         ///< both joints as Fourier series
  };
  Kind kind = Kind::kSeries;
  double base_frequency = 0.05;  ///< Hz, of the series
  std::array<JointSeries, kJoints> series;
};

ManipulatorMotion ParallelogramMotion();
/// Series of random phases through most of the joints' ranges, different for each seed.
ManipulatorMotion DrawnMotion(std::uint64_t seed);

TipReference ReferenceAt(const ManipulatorTruth& truth, const ManipulatorMotion& motion, double time);
/// Joint angles at which the motion begins.
std::array<double, kJoints> BeginningOf(const ManipulatorTruth& truth, const ManipulatorMotion& motion);

}  // namespace hydroscope
