#include <algorithm>
#include <cmath>

#include "simulator/die_cushion/press.h"
#include "simulator/random.h"

namespace hydroscope {

PressOptions RandomMachine(std::uint64_t seed) {
  RandomStream random(StreamSeed(seed, "machine"));
  PressOptions o;
  o.seed = seed;
  PressMachine& m = o.machine;
  m.K = random.Uniform(0.8e9, 1.7e9);
  m.V0 = random.Uniform(0.8e-3, 3e-3);
  m.A_A = random.Uniform(0.008, 0.020);
  m.A_B = m.A_A * random.Uniform(0.5, 0.8);
  m.Q_vn = random.Uniform(60, 160) / 6e4;
  m.y_0 = random.Uniform(-0.02, 0.02);
  m.p_rod = random.Uniform(40e5, 80e5);
  m.valve_f0 = random.Uniform(80, 250);
  m.valve_damping = random.Uniform(0.5, 0.9);
  m.valve_gain = random.Uniform(0.95, 1.05);
  m.valve_dead_time = random.Uniform(0, 1e-3);

  PressMotion& w = o.motion;
  const double conductance = m.Q_vn / std::sqrt(m.dp_nom);
  w.set_point_min = random.Uniform(30e5, 60e5);
  w.set_point_max = random.Uniform(150e5, 210e5);
  // Speeds at which 70 % opening is enough at the middle pressure; the set point generator raises lower levels.
  const double middle = (w.set_point_min + w.set_point_max) / 2;
  const double fastest = 0.7 * conductance * std::sqrt(middle) / m.A_A;
  w.speed_max = std::min(random.Uniform(0.080, 0.150), fastest);
  w.speed_min = w.speed_max * random.Uniform(0.15, 0.35);
  w.return_speed = std::min(0.120, 0.6 * conductance * std::sqrt(m.p_supply - w.rest_pressure) / m.A_A);
  w.z_top = random.Uniform(0.15, 0.25);
  w.z_bottom = random.Uniform(0.008, 0.020);
  return o;
}

std::array<PressOptions, 4> FourCushions(const PressOptions& options) {
  const std::vector<PressOptions> cushions = Cushions(options, 4);
  return {cushions[0], cushions[1], cushions[2], cushions[3]};
}

std::vector<PressOptions> Cushions(const PressOptions& options, int count) {
  std::vector<PressOptions> cushions(static_cast<std::size_t>(count));
  for (std::size_t k = 0; k < cushions.size(); ++k) {
    RandomStream random(StreamSeed(options.seed + k, "cushion"));
    PressOptions& o = cushions[k] = options;
    const auto spread = [&](double value, double share) {
      return value * (1 + random.Uniform(-share, share));
    };
    o.control_seed = StreamSeed(options.control_seed + options.seed + k, "cushion control");
    o.noise_seed = StreamSeed(options.noise_seed + options.seed + k, "cushion noise");
    o.machine.K = spread(options.machine.K, 0.05);
    o.machine.V0 = spread(options.machine.V0, 0.04);
    o.machine.Q_vn = spread(options.machine.Q_vn, 0.04);
    o.machine.y_0 = options.machine.y_0 + random.Uniform(-0.004, 0.004);
    o.machine.valve_f0 = spread(options.machine.valve_f0, 0.05);
    o.machine.valve_damping = spread(options.machine.valve_damping, 0.05);
  }
  return cushions;
}

}  // namespace hydroscope
