#include "simulator/manipulator/motion.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "simulator/random.h"

namespace hydroscope {
namespace {

constexpr double kSide = 3.0;  // s from corner to corner
constexpr std::array<TipPosition, 4> kCorners = {{{2.5, -0.9}, {3.5, -0.9}, {3.6, 1.1}, {2.6, 1.1}}};

/// Middle and half width of what the default motion uses of each joint's range, rad.
constexpr std::array<double, kJoints> kMiddle = {0.35, -1.6}, kHalfRange = {0.50, 0.60};

struct AngleAt {
  double angle, speed;
};
AngleAt SeriesAt(const JointSeries& series, double base_frequency, double time) {
  AngleAt out{series.centre, 0};
  const double w = 2 * std::numbers::pi * base_frequency;
  for (std::size_t k = 0; k < series.terms.size(); ++k) {
    const double n = static_cast<double>(k + 1) * w, s = std::sin(n * time), c = std::cos(n * time);
    out.angle += series.terms[k].sine * s + series.terms[k].cosine * c;
    out.speed += n * (series.terms[k].sine * c - series.terms[k].cosine * s);
  }
  return out;
}

TipReference OnParallelogram(double time) {
  const double sides = time / kSide;
  const auto corner = static_cast<std::size_t>(std::max(0.0, std::floor(sides)));
  const double s = sides - std::floor(sides);
  const double share = s * s * s * (10 + s * (-15 + 6 * s)), rate = 30 * s * s * (1 - s) * (1 - s) / kSide;
  const TipPosition &from = kCorners[corner % 4], &to = kCorners[(corner + 1) % 4];
  const TipPosition way{to.x - from.x, to.y - from.y};
  return {{from.x + share * way.x, from.y + share * way.y}, {rate * way.x, rate * way.y}};
}

}  // namespace

ManipulatorMotion ParallelogramMotion() {
  ManipulatorMotion motion;
  motion.kind = ManipulatorMotion::Kind::kParallelogram;
  return motion;
}

ManipulatorMotion DrawnMotion(std::uint64_t seed) {
  constexpr int kTerms = 6;
  ManipulatorMotion motion;
  RandomStream random(StreamSeed(seed, "manipulator motion"));
  for (std::size_t i = 0; i < kJoints; ++i) {
    JointSeries& series = motion.series[i];
    series.centre = kMiddle[i];
    for (int k = 1; k <= kTerms; ++k) {
      const double phase = random.Uniform(0, 2 * std::numbers::pi), size = random.Uniform(0.4, 1) / k;
      series.terms.push_back({size * std::sin(phase), size * std::cos(phase)});
    }
    double largest = 0;
    for (int n = 0; n < 2000; ++n) {
      const double time = n / 2000.0 / motion.base_frequency;
      largest =
          std::max(largest, std::abs(SeriesAt(series, motion.base_frequency, time).angle - series.centre));
    }
    for (JointSeries::Term& term : series.terms) {
      term.sine *= kHalfRange[i] / largest;
      term.cosine *= kHalfRange[i] / largest;
    }
  }
  return motion;
}

TipReference ReferenceAt(const ManipulatorTruth& truth, const ManipulatorMotion& motion, double time) {
  if (motion.kind == ManipulatorMotion::Kind::kParallelogram) return OnParallelogram(time);
  const AngleAt a = SeriesAt(motion.series[0], motion.base_frequency, time),
                b = SeriesAt(motion.series[1], motion.base_frequency, time);
  const TipPosition tip = TipOf(truth, a.angle, b.angle);
  const double x_elbow = truth.links[0].length * std::cos(a.angle),
               y_elbow = truth.links[0].length * std::sin(a.angle);
  return {tip,
          {-tip.y * a.speed - (tip.y - y_elbow) * b.speed, tip.x * a.speed + (tip.x - x_elbow) * b.speed}};
}

std::array<double, kJoints> BeginningOf(const ManipulatorTruth& truth, const ManipulatorMotion& motion) {
  return AnglesOf(truth, ReferenceAt(truth, motion, 0).position);
}

}  // namespace hydroscope
