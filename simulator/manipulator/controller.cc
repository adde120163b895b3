#include "simulator/manipulator/controller.h"

#include <algorithm>
#include <cmath>

namespace hydroscope {
namespace {

constexpr double kWeight = 9.81;    // m/s2
constexpr double kLeastDrop = 1e4;  // Pa, below which an edge is not asked for more opening
constexpr double kDrySpeed = 5e-3;  // m/s, over which compensated Coulomb friction turns

/// Torques that the rigid bodies of the model need: Lagrange's equations of the two-link arm.
std::array<double, kJoints> RequiredTorque(const std::array<double, 6>& m, double a_1,
                                           const std::array<double, kJoints>& q,
                                           const std::array<double, kJoints>& w,
                                           const std::array<double, kJoints>& a) {
  const double c = std::cos(q[1]), s = std::sin(q[1]);
  const double coupled = a_1 * (m[3] * c - m[4] * s), bent = a_1 * (m[3] * s + m[4] * c);
  const double both = q[0] + q[1];
  const double weight_2 = kWeight * (m[3] * std::cos(both) - m[4] * std::sin(both));
  const double weight_1 = kWeight * (m[0] * std::cos(q[0]) - m[1] * std::sin(q[0])) + weight_2;
  return {(m[2] + m[5] + 2 * coupled) * a[0] + (m[5] + coupled) * a[1] -
              bent * (2 * w[0] * w[1] + w[1] * w[1]) + weight_1,
          (m[5] + coupled) * a[0] + m[5] * a[1] + bent * w[0] * w[0] + weight_2};
}

}  // namespace

ControllerModel TrueModel(const ManipulatorTruth& truth) {
  const LinkTruth &a = truth.links[0], &b = truth.links[1];
  const double carried = b.mass + truth.payload;
  ControllerModel model;
  model.rigid = {
      a.mass * a.c_x + carried * a.length,
      a.mass * a.c_y,
      a.inertia_centre + a.mass * (a.c_x * a.c_x + a.c_y * a.c_y) + carried * a.length * a.length,
      b.mass * b.c_x + truth.payload * b.length,
      b.mass * b.c_y,
      b.inertia_centre + b.mass * (b.c_x * b.c_x + b.c_y * b.c_y) + truth.payload * b.length * b.length};
  for (std::size_t i = 0; i < kJoints; ++i) {
    const CylinderTruth& c = truth.cylinders[i];
    model.b[i] = c.b;
    model.F_c[i] = c.F_c;
    model.K[i] = c.K;
    model.edges[i] = {c.C_PA, c.C_AT, c.C_PB, c.C_BT};
  }
  return model;
}

ControllerModel DatasheetModel(const ManipulatorTruth& truth) {
  constexpr double kDatasheetEdge = 6.30e-7, kDatasheetModulus = 1.4e9;
  ControllerModel model = TrueModel(truth);
  model.rigid = {1121.4, 4.7, 1738.0, 1099.5, 11.5, 2074.7};
  model.F_c = {};
  model.K = {kDatasheetModulus, kDatasheetModulus};
  for (auto& edges : model.edges) edges.fill(kDatasheetEdge);
  return model;
}

ControllerGains GainsOf(const ControllerModel& model, const ControllerRates& rates) {
  ControllerGains gains{rates.position, rates.piston, {}, {}};
  gains.k_v = {rates.speed * model.rigid[2], rates.speed * model.rigid[5]};
  for (std::size_t i = 0; i < kJoints; ++i) gains.k_f[i] = rates.force / model.K[i];
  return gains;
}

double ManipulatorController::Smoothed::Take(double value, double smoothing) {
  if (begun) rate += smoothing * ((value - last) / kPeriod - rate);
  last = value;
  begun = true;
  return rate;
}

std::array<double, kJoints> ManipulatorController::Command(const ManipulatorReadings& readings,
                                                           const TipReference& reference) {
  const auto& q = readings.q;
  const double a_1 = geometry_.links[0].length;
  const TipPosition tip = TipOf(geometry_, q[0], q[1]);
  // Required joint speeds, eq. 19.
  const double v_x = reference.speed.x + gains_.k_p * (reference.position.x - tip.x);
  const double v_y = reference.speed.y + gains_.k_p * (reference.position.y - tip.y);
  const double x_2 = tip.x - a_1 * std::cos(q[0]), y_2 = tip.y - a_1 * std::sin(q[0]);
  const double det = -tip.y * x_2 + y_2 * tip.x;
  const std::array<double, kJoints> required = {(x_2 * v_x + y_2 * v_y) / det,
                                                (-tip.x * v_x - tip.y * v_y) / det};
  std::array<double, kJoints> w{}, a{};
  for (std::size_t i = 0; i < kJoints; ++i) {
    w[i] = speed_[i].Take(q[i], smoothing_);
    a[i] = required_[i].Take(required[i], smoothing_);
  }
  // Required torques, eq. 20: feedback on the spatial speed of each body, the elbow's included.
  std::array<double, kJoints> torque = RequiredTorque(model_.rigid, a_1, q, w, a);
  const double error_1 = required[0] - w[0], error_2 = error_1 + required[1] - w[1];
  torque[1] += gains_.k_v[1] * error_2;
  torque[0] += gains_.k_v[0] * error_1 + gains_.k_v[1] * (error_2 + a_1 * a_1 * error_1);
  std::array<double, kJoints> command{};
  for (std::size_t i = 0; i < kJoints; ++i) {
    const CylinderTruth& c = geometry_.cylinders[i];
    const auto& edge = model_.edges[i];
    const CylinderReach reach = ReachOf(c, q[i]);
    const double x_1 = reach.x + c.V_0 / c.A_1, x_2nd = c.stroke - reach.x + c.V_0 / c.A_2;
    const double speed = reach.lever * w[i], wanted = reach.lever * required[i];
    // Required force and flow, eq. 21 ... 23 with the speed and the sign that eq. 23 lacks.
    const double force =
        torque[i] / reach.lever + model_.b[i] * speed + model_.F_c[i] * std::tanh(wanted / kDrySpeed);
    const double rate = force_[i].Take(force, smoothing_);
    const double now = readings.p_1[i] * c.A_1 - readings.p_2[i] * c.A_2;
    measured_force_[i] = begun_ ? measured_force_[i] + smoothing_ * (now - measured_force_[i]) : now;
    const double flow = -(c.A_1 / x_1 + c.A_2 / x_2nd) * wanted - rate / model_.K[i] -
                        gains_.k_f[i] * (force - measured_force_[i]) - gains_.k_x * (wanted - speed);
    const auto root = [](double drop) { return std::sqrt(std::max(drop, kLeastDrop)); };
    const double p_1 = readings.p_1[i], p_2 = readings.p_2[i];
    const double gain =
        flow < 0 ? edge[0] * root(readings.p_s - p_1) / x_1 + edge[3] * root(p_2 - geometry_.p_t) / x_2nd
                 : edge[1] * root(p_1 - geometry_.p_t) / x_1 + edge[2] * root(readings.p_s - p_2) / x_2nd;
    command[i] = std::clamp(-flow / gain, -1.0, 1.0);
  }
  begun_ = true;
  return command;
}

}  // namespace hydroscope
