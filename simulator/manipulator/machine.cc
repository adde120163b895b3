#include "simulator/manipulator/machine.h"

#include <cmath>

#include "simulator/random.h"

namespace hydroscope {

ManipulatorTruth PublishedManipulator() {
  ManipulatorTruth m;
  // Masses of table I; centres and inertias such that the base parameters are those identified there:
  // m c_x1 + m_2 a_1 = 1111.6, m c_y1 = -117.3, I_1 + m_2 a_1^2 = 2305.2, 1074.2, -73.1, 2458.4 (a_1 = 1.6 m: the CAD's
  // 1738.0 - 95.97 over m_2).
  m.links[0] = {128.51, 85.328 / 128.51, -117.3 / 128.51, 499.4, 1.6};
  m.links[1] = {641.42, 1074.2 / 641.42, -73.1 / 641.42, 651.1, 2.5};
  m.cylinders[0] = {1.10,        0.45,    0.90,    0.80,    0.72,    7.854e-3, 5.391e-3, 4e-4,
                    1 / 1.37e-9, 7.25e-7, 6.90e-7, 7.48e-7, 7.24e-7, 39872.0,  800.0};
  m.cylinders[1] = {1.25,        0.42,    2.80,    0.88,    0.78,    7.854e-3, 5.391e-3, 4e-4,
                    1 / 1.60e-9, 9.03e-7, 8.67e-7, 6.44e-7, 6.82e-7, 77347.0,  800.0};
  return m;
}

ManipulatorTruth DrawnManipulator(unsigned long seed) {
  ManipulatorTruth m = PublishedManipulator();
  RandomStream random(StreamSeed(seed, "manipulator"));
  const auto vary = [&](double& value, double share) { value *= 1 + random.Uniform(-share, share); };
  for (LinkTruth& link : m.links)
    for (double* value : {&link.mass, &link.c_x, &link.c_y, &link.inertia_centre}) vary(*value, 0.1);
  for (CylinderTruth& c : m.cylinders) {
    for (double* value : {&c.C_PA, &c.C_AT, &c.C_PB, &c.C_BT, &c.K, &c.b}) vary(*value, 0.2);
    vary(c.F_c, 0.5);
  }
  return m;
}

CylinderReach ReachOf(const CylinderTruth& c, double q) {
  const double angle = q + c.q_0;
  const double length = std::sqrt(c.l_1 * c.l_1 + c.l_2 * c.l_2 - 2 * c.l_1 * c.l_2 * std::cos(angle));
  return {length - c.x_0, c.l_1 * c.l_2 * std::sin(angle) / length};
}

TipPosition TipOf(const ManipulatorTruth& truth, double q_1, double q_2) {
  const double a = truth.links[0].length, b = truth.links[1].length;
  return {a * std::cos(q_1) + b * std::cos(q_1 + q_2), a * std::sin(q_1) + b * std::sin(q_1 + q_2)};
}

std::array<double, kJoints> AnglesOf(const ManipulatorTruth& truth, const TipPosition& tip) {
  const double a = truth.links[0].length, b = truth.links[1].length;
  const double q_2 = -std::acos((tip.x * tip.x + tip.y * tip.y - a * a - b * b) / (2 * a * b));
  return {std::atan2(tip.y, tip.x) - std::atan2(b * std::sin(q_2), a + b * std::cos(q_2)), q_2};
}

}  // namespace hydroscope
