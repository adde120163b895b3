#include "simulator/test_cylinder/plant.h"

#include <algorithm>
#include <cmath>

#include "core/constants.h"

namespace hydroscope {
namespace {

// s: a hundredth of the fastest time constant, Coulomb friction's edge included.
constexpr double kStep = 25e-6;
constexpr double kCoulombSpeed = 1e-3;  // m/s, within which Coulomb friction turns over
constexpr double kLeastPressure = 1e5;  // Pa: below, a chamber would cavitate

double Squared(double x) { return x * x; }

}  // namespace

TestCylinderPlant::TestCylinderPlant(const TestCylinderOptions& o) { Become(o); }

void TestCylinderPlant::Become(const TestCylinderOptions& o) {
  options_ = o;
  const double w_h = kTwoPi * o.f_h;
  // w_h^2 = 4 K A^2/(V m) and 2 zeta/w_h = B/(m w_h^2) + C m/A^2, as if neither friction nor leakage changed the other terms.
  compressibility_ = 4 * Squared(o.area) / (o.volume * o.mass * Squared(w_h));
  friction_ = (1 - o.leak_share) * 2 * o.zeta_h * w_h * o.mass;
  leakage_ = o.leak_share * 2 * o.zeta_h / w_h * Squared(o.area) / o.mass + o.leakage;
}

TestCylinderPlant::State TestCylinderPlant::Rates(const State& state, double current) const {
  const TestCylinderOptions& o = options_;
  const auto [spool, pressure, speed, position] = state;
  double flow = o.K_sv * spool;
  if (o.square_root_valve)
    flow *= std::sqrt(std::max(0.0, 1 - std::copysign(1.0, spool) * pressure / o.supply));
  double compressibility = compressibility_;
  if (o.trapped_air > 0) {
    const double mean = o.supply / 2;
    const double p_1 = std::max(kLeastPressure, mean + pressure / 2),
                 p_2 = std::max(kLeastPressure, mean - pressure / 2);
    compressibility += o.trapped_air * mean * (1 / Squared(p_1) + 1 / Squared(p_2)) / 2;
  }
  double force = o.area * pressure - friction_ * speed - o.specimen * position;
  if (o.coulomb > 0) force -= o.coulomb * std::tanh(speed / kCoulombSpeed);
  return {kTwoPi * o.f_sv * (current - spool),
          (flow - o.area * speed - leakage_ * pressure) * 4 / (o.volume * compressibility), force / o.mass,
          speed};
}

void TestCylinderPlant::Advance(double current, double seconds) {
  if (options_.saturation > 0) current = std::clamp(current, -options_.saturation, options_.saturation);
  const int steps = std::max(1, static_cast<int>(std::ceil(seconds / kStep - 1e-9)));
  const double h = seconds / steps;
  const auto moved = [](const State& from, double by, const State& rate) {
    State to = from;
    for (std::size_t i = 0; i < to.size(); ++i) to[i] += by * rate[i];
    return to;
  };
  for (int k = 0; k < steps; ++k) {  // Runge and Kutta's method of order 4
    const State a = Rates(state_, current), b = Rates(moved(state_, h / 2, a), current);
    const State c = Rates(moved(state_, h / 2, b), current), d = Rates(moved(state_, h, c), current);
    for (std::size_t i = 0; i < state_.size(); ++i) state_[i] += h / 6 * (a[i] + 2 * b[i] + 2 * c[i] + d[i]);
  }
}

}  // namespace hydroscope
