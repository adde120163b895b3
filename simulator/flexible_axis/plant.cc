#include "simulator/flexible_axis/plant.h"

#include <algorithm>
#include <cmath>

namespace hydroscope {
namespace {

/// Flow through an opening, in its sign of the pressure difference; linear within a hundredth of a bar of 0.
double RootOfDifference(double difference) {
  constexpr double kLaminarPa = 1e3;
  return difference / std::pow(difference * difference + kLaminarPa * kLaminarPa, 0.25);
}

double SignOf(double x) { return (x > 0) - (x < 0); }

}  // namespace

const std::vector<FlexibleAxisFault>& AllFlexibleAxisFaults() {
  using F = FlexibleAxisFaults;
  static const std::vector<FlexibleAxisFault> all = {
      {"supply_drop", &F::supply_drop, 2e6, "Pa", "supply pressure below what the machine file says"},
      {"spool_zero", &F::spool_zero, 0.05, "V", "the spool is closed at another command than 0"},
      {"spool_overlap", &F::spool_overlap, 0.1, "V", "command without flow, to either side"},
      {"spring_loss", &F::spring_loss, 0.15, "1", "share of the spring's stiffness that is lost"},
      {"load_friction", &F::load_friction, 60, "N", "Coulomb friction in the guide of the load"},
      {"retraction_friction", &F::retraction_friction, 150, "N",
       "more friction while the rod moves in (wiper)"},
      {"free_air", &F::free_air, 0.01, "1", "undissolved air, share of the volume at 1 bar"},
      {"worn_edges", &F::worn_edges, 0.05, "V", "opening that the closed metering edges keep"},
      {"load_mass", &F::load_mass, 15, "kg", "mass on the load"},
      {"load_position_zero", &F::load_position_zero, 0.005, "m", "zero of the load's position sensor"},
      {"pressure_1_zero", &F::pressure_1_zero, 3e5, "Pa", "zero of the piston-side pressure sensor"},
      {"acceleration_zero", &F::acceleration_zero, 0.2, "m/s^2", "zero of the acceleration sensor"},
  };
  return all;
}

double FlexibleAxisMachine::BulkModulus(double pressure) const {
  constexpr double kLargest = 1.8e9, kHighestPressure = 28e6;
  return modulus_factor * kLargest * std::log10(modulus_rise * pressure / kHighestPressure + modulus_shift);
}

FlexibleAxisState FlexibleAxisPlant::Rest(double position) const {
  FlexibleAxisState s;
  s.x_p = s.x_l = position;
  s.p_1 = 3e6;
  s.p_2 = 5e6;
  s.bristle = (s.p_1 * m_.piston_area - s.p_2 * m_.ring_area) / m_.bristle_stiffness;
  return s;
}

/// g(v), N: what the bristles carry once they slip.
double FlexibleAxisPlant::FrictionAtRest(double speed) const {
  const double ratio = speed / m_.stribeck_speed;
  const double coulomb = m_.coulomb_friction + (speed < 0 ? f_.retraction_friction : 0.0);
  return coulomb + (m_.static_friction - m_.coulomb_friction) * std::exp(-ratio * ratio);
}

double FlexibleAxisPlant::BristleRate(const FlexibleAxisState& s) const {
  return s.v_p - std::abs(s.v_p) * m_.bristle_stiffness * s.bristle / FrictionAtRest(s.v_p);
}

double FlexibleAxisPlant::Acceleration(const FlexibleAxisState& s) const {
  const double friction =
      m_.bristle_stiffness * s.bristle + m_.bristle_damping * BristleRate(s) + m_.viscous_friction * s.v_p;
  const double spring = (1 - f_.spring_loss) * m_.spring * (s.x_p - s.x_l) + m_.damper * (s.v_p - s.v_l);
  return (s.p_1 * m_.piston_area - s.p_2 * m_.ring_area - friction - spring) / m_.piston_mass;
}

/// The stiffness of oil with free air, both in series (isothermal air).
double FlexibleAxisPlant::PressureRate(double pressure, double volume, double flow) const {
  constexpr double kBar = 1e5, kAtmospherePa = 1.013e5;
  const double oil = m_.BulkModulus(pressure), absolute = std::max(pressure, 0.0) + kAtmospherePa;
  const double compliance = 1 / oil + f_.free_air * kBar / (absolute * absolute);
  return flow / (volume * compliance);
}

double FlexibleAxisPlant::Opening(double spool) const {
  const double opening = spool - f_.spool_zero;
  return SignOf(opening) * std::max(std::abs(opening) - f_.spool_overlap, 0.0);
}

FlexibleAxisPlant::Rates FlexibleAxisPlant::RatesAt(const FlexibleAxisState& s, double command) const {
  const double supply = m_.supply_pressure - f_.supply_drop, tank = m_.tank_pressure;
  const double opening = Opening(s.spool), in = std::max(opening, 0.0) + f_.worn_edges,
               out = std::max(-opening, 0.0) + f_.worn_edges;
  const double flow_1 =
      m_.flow_gain * (in * RootOfDifference(supply - s.p_1) - out * RootOfDifference(s.p_1 - tank));
  const double flow_2 =
      m_.flow_gain * (out * RootOfDifference(supply - s.p_2) - in * RootOfDifference(s.p_2 - tank));
  const double inside = m_.internal_leakage * (s.p_2 - s.p_1);
  const double volume_1 = m_.piston_pipe_volume + m_.piston_area * s.x_p,
               volume_2 = m_.ring_pipe_volume + m_.ring_area * (m_.stroke - s.x_p);
  const double spring = (1 - f_.spring_loss) * m_.spring * (s.x_p - s.x_l) + m_.damper * (s.v_p - s.v_l);
  const double guide = f_.load_friction * std::tanh(s.v_l / 1e-3);
  return {s.v_p,
          Acceleration(s),
          s.v_l,
          (spring - guide) / (m_.load_mass + f_.load_mass),
          PressureRate(s.p_1, volume_1,
                       flow_1 - m_.piston_area * s.v_p + inside - m_.external_leakage_1 * (s.p_1 - tank)),
          PressureRate(s.p_2, volume_2,
                       flow_2 + m_.ring_area * s.v_p - inside - m_.external_leakage_2 * (s.p_2 - tank)),
          (command - s.spool) / m_.spool_time,
          BristleRate(s)};
}

void FlexibleAxisPlant::Advance(double command, double seconds, FlexibleAxisState& s) const {
  constexpr double kLongest = 5e-5;   // s; the fastest motion beside the bristles needs ten times that
  constexpr double kOfBristle = 0.5;  // of the time in which the bristles slip
  const double slip = std::abs(s.v_p) * m_.bristle_stiffness / FrictionAtRest(s.v_p);
  const auto steps =
      static_cast<int>(std::ceil(seconds / std::min(kLongest, kOfBristle / std::max(slip, 1.0))));
  const double h = seconds / steps;
  const auto moved = [](const FlexibleAxisState& from, const Rates& r, double t) {
    return FlexibleAxisState{from.x_p + t * r[0],   from.v_p + t * r[1],    from.x_l + t * r[2],
                             from.v_l + t * r[3],   from.p_1 + t * r[4],    from.p_2 + t * r[5],
                             from.spool + t * r[6], from.bristle + t * r[7]};
  };
  for (int k = 0; k < steps; ++k) {
    const Rates a = RatesAt(s, command), b = RatesAt(moved(s, a, h / 2), command),
                c = RatesAt(moved(s, b, h / 2), command), d = RatesAt(moved(s, c, h), command);
    Rates mean;
    for (std::size_t i = 0; i < mean.size(); ++i) mean[i] = (a[i] + 2 * b[i] + 2 * c[i] + d[i]) / 6;
    s = moved(s, mean, h);
  }
}

}  // namespace hydroscope
