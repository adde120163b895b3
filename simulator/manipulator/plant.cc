#include "simulator/manipulator/plant.h"

#include <algorithm>
#include <cmath>

namespace hydroscope {
namespace {

constexpr double kGravity = 9.81;        // m/s2
constexpr double kLongestStep = 2.5e-4;  // s; the fastest are rod contact (1 ms) and spool (2.3 ms)
constexpr double kLaminarRange = 2e4;    // Pa, below which an edge is laminar, so that its flow has a slope
constexpr double kSlip = 1e-3;           // m/s, over which Coulomb friction turns
constexpr double kContact = 4e7;         // N/m, of a joint with play
constexpr double kStop = 1e8;            // N/m, of the cylinder's ends

struct Planar {
  double x = 0, y = 0;
};
Planar operator+(Planar a, Planar b) { return {a.x + b.x, a.y + b.y}; }
Planar operator*(double s, Planar a) { return {s * a.x, s * a.y}; }
double Cross(Planar a, Planar b) { return a.x * b.y - a.y * b.x; }
/// alpha x r + omega x (omega x r).
Planar Carried(double alpha, double omega, Planar r) {
  return {-alpha * r.y - omega * omega * r.x, alpha * r.x - omega * omega * r.y};
}
Planar Turned(double angle, double x, double y) {
  return {x * std::cos(angle) - y * std::sin(angle), x * std::sin(angle) + y * std::cos(angle)};
}

double EdgeRoot(double difference) {
  return difference / std::sqrt(std::sqrt(difference * difference + kLaminarRange * kLaminarRange));
}

/// Opening of an edge that opens with `u`; a worn one is round.
double EdgeOpening(double u, double radius) {
  return radius > 0 ? 0.5 * (u + std::sqrt(u * u + radius * radius)) : std::max(u, 0.0);
}

/// Without the viscous part.
double DryFriction(const CylinderTruth& c, double speed) {
  const double ratio = speed / c.v_stribeck;
  return (c.F_c + c.F_stribeck * std::exp(-ratio * ratio)) * std::tanh(speed / kSlip);
}

double PressureForce(const CylinderTruth& c, double p_1, double p_2) { return p_1 * c.A_1 - p_2 * c.A_2; }

/// Force of joint pins with play, from the rod's place in it.
double ContactForce(const CylinderTruth& c, double rod) {
  const double gap = 0.5 * c.play;
  return kContact * (rod > gap ? rod - gap : rod < -gap ? rod + gap : 0.0);
}

double StopForce(const CylinderTruth& c, double x) {
  return kStop * (std::max(-x, 0.0) - std::max(x - c.stroke, 0.0));
}

void AddScaled(ManipulatorState& to, double factor, const ManipulatorState& rate) {
  for (std::size_t i = 0; i < kJoints; ++i) {
    to.q[i] += factor * rate.q[i];
    to.w[i] += factor * rate.w[i];
    to.p_1[i] += factor * rate.p_1[i];
    to.p_2[i] += factor * rate.p_2[i];
    to.spool[i] += factor * rate.spool[i];
    to.v[i] += factor * rate.v[i];
    to.rod[i] += factor * rate.rod[i];
  }
  to.p_s += factor * rate.p_s;
}

}  // namespace

std::array<double, kJoints> InverseDynamics(const ManipulatorTruth& truth, const ManipulatorState& state,
                                            const std::array<double, kJoints>& acceleration) {
  const LinkTruth &a = truth.links[0], &b = truth.links[1];
  const double turn_1 = state.q[0], turn_2 = state.q[0] + state.q[1];
  const double speed_2 = state.w[0] + state.w[1], alpha_2 = acceleration[0] + acceleration[1];
  // Outwards: the base is accelerated upwards in place of gravity.
  const Planar base{0, kGravity};
  const Planar centre_1 = Turned(turn_1, a.c_x, a.c_y), elbow = Turned(turn_1, a.length, 0),
               centre_2 = Turned(turn_2, b.c_x, b.c_y), tip = Turned(turn_2, b.length, 0);
  const Planar at_elbow = base + Carried(acceleration[0], state.w[0], elbow);
  const Planar force_1 = a.mass * (base + Carried(acceleration[0], state.w[0], centre_1));
  const Planar force_2 = b.mass * (at_elbow + Carried(alpha_2, speed_2, centre_2));
  const Planar force_tip = truth.payload * (at_elbow + Carried(alpha_2, speed_2, tip));
  // Inwards.
  const double torque_2 = b.inertia_centre * alpha_2 + Cross(centre_2, force_2) + Cross(tip, force_tip);
  const double torque_1 = a.inertia_centre * acceleration[0] + Cross(centre_1, force_1) +
                          Cross(elbow, force_2 + force_tip) + torque_2;
  return {torque_1, torque_2};
}

double RodForce(const CylinderTruth& c, const ManipulatorState& state, int joint) {
  const auto i = static_cast<std::size_t>(joint);
  const CylinderReach reach = ReachOf(c, state.q[i]);
  const double stop = StopForce(c, reach.x);
  if (c.play > 0) return ContactForce(c, state.rod[i]) + stop;
  const double speed = reach.lever * state.w[i];
  return PressureForce(c, state.p_1[i], state.p_2[i]) - c.b * speed - DryFriction(c, speed) + stop;
}

ManipulatorPlant::ManipulatorPlant(const ManipulatorTruth& truth, const std::array<double, kJoints>& q)
    : truth_(truth) {
  state_.q = q;
  state_.p_s = truth.p_supply;
  const std::array<double, kJoints> torque = InverseDynamics(truth, state_, {});
  for (std::size_t i = 0; i < kJoints; ++i) {
    const CylinderTruth& c = truth.cylinders[i];
    const double force = torque[i] / ReachOf(c, q[i]).lever;
    const double resting = 0.3 * truth.p_supply;  // of the side that does not carry
    state_.p_2[i] = std::max(resting, (c.A_1 * resting - force) / c.A_2);
    state_.p_1[i] = (force + c.A_2 * state_.p_2[i]) / c.A_1;
    if (c.play > 0) state_.rod[i] = force / kContact + std::copysign(0.5 * c.play, force);
  }
}

ManipulatorState ManipulatorPlant::Rate(const ManipulatorState& x,
                                        const std::array<double, kJoints>& command) const {
  ManipulatorState rate;
  rate.q = x.w;
  double drawn = 0;  // m3/s, from the supply
  std::array<double, kJoints> torque{};
  for (std::size_t i = 0; i < kJoints; ++i) {
    const CylinderTruth& c = truth_.cylinders[i];
    const CylinderReach reach = ReachOf(c, x.q[i]);
    torque[i] = reach.lever * RodForce(c, x, static_cast<int>(i));
    double speed = reach.lever * x.w[i];  // of the piston
    if (c.play > 0) {                     // the rod weighs nothing beside the arm
      const double driving = PressureForce(c, x.p_1[i], x.p_2[i]) - ContactForce(c, x.rod[i]);
      const double piston = (driving - DryFriction(c, speed)) / c.b;
      rate.rod[i] = piston - speed;
      speed = piston;
    }
    const double u = x.spool[i];
    const double in_1 = c.C_PA * EdgeOpening(u, c.worn[0]) * EdgeRoot(x.p_s - x.p_1[i]);
    const double out_1 = c.C_AT * EdgeOpening(-u, c.worn[1]) * EdgeRoot(x.p_1[i] - truth_.p_t);
    const double in_2 = c.C_PB * EdgeOpening(-u, c.worn[2]) * EdgeRoot(x.p_s - x.p_2[i]);
    const double out_2 = c.C_BT * EdgeOpening(u, c.worn[3]) * EdgeRoot(x.p_2[i] - truth_.p_t);
    const double travel = std::clamp(reach.x, 0.0, c.stroke);
    rate.p_1[i] = c.K / (c.V_0 + c.A_1 * travel) * (in_1 - out_1 - c.A_1 * speed);
    rate.p_2[i] = c.K / (c.V_0 + c.A_2 * (c.stroke - travel)) * (in_2 - out_2 + c.A_2 * speed);
    drawn += in_1 + in_2;
    rate.spool[i] = x.v[i];
    rate.v[i] = truth_.spool_rate * truth_.spool_rate * (std::clamp(command[i], -1.0, 1.0) - u) -
                2 * truth_.spool_damping * truth_.spool_rate * x.v[i];
  }
  rate.p_s = (truth_.p_supply - truth_.supply_drop * drawn - x.p_s) / truth_.supply_lag;
  // M a = torque - bias; the columns of M are torques of unit accelerations.
  const auto bias = InverseDynamics(truth_, x, {});
  const auto first = InverseDynamics(truth_, x, {1, 0}), second = InverseDynamics(truth_, x, {0, 1});
  const double m_11 = first[0] - bias[0], m_21 = first[1] - bias[1], m_12 = second[0] - bias[0],
               m_22 = second[1] - bias[1];
  const double t_1 = torque[0] - bias[0], t_2 = torque[1] - bias[1], det = m_11 * m_22 - m_12 * m_21;
  rate.w = {(m_22 * t_1 - m_12 * t_2) / det, (m_11 * t_2 - m_21 * t_1) / det};
  return rate;
}

void ManipulatorPlant::Run(const std::array<double, kJoints>& command, double seconds) {
  const int steps = std::max(1, static_cast<int>(std::ceil(seconds / kLongestStep - 1e-9)));
  const double h = seconds / steps;
  const auto moved = [&](double share, const ManipulatorState& rate) {
    ManipulatorState out = state_;
    AddScaled(out, share * h, rate);
    return out;
  };
  for (int s = 0; s < steps; ++s) {
    const ManipulatorState a = Rate(state_, command);
    const ManipulatorState b = Rate(moved(0.5, a), command);
    const ManipulatorState c = Rate(moved(0.5, b), command);
    const ManipulatorState d = Rate(moved(1, c), command);
    AddScaled(state_, h / 6, a);
    AddScaled(state_, h / 3, b);
    AddScaled(state_, h / 3, c);
    AddScaled(state_, h / 6, d);
  }
}

}  // namespace hydroscope
