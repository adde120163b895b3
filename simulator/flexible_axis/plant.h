#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/result.h"

namespace hydroscope {

/// A servo axis whose cylinder moves a mass that carries a second one on a spring (Yousefi, Handroos and Soleymani,
/// Mechatronics 18, 2008): known sizes of table 1, and those of table 3 with its misprints put right (docs/flexible_axis.md).
struct FlexibleAxisMachine {
  double piston_mass = 210, load_mass = 80;                         ///< kg
  double piston_area = 8.04e-4, ring_area = 4.24e-4;                ///< m^2
  double piston_pipe_volume = 2.13e-4, ring_pipe_volume = 1.07e-4;  ///< m^3
  double stroke = 1;                                                ///< m
  double tank_pressure = 0.9e6, supply_pressure = 14e6;             ///< Pa
  double spring = 42950;                                            ///< N/m

  double damper = 418.335;                                                         ///< N s/m
  double spool_time = 1 / 470.0;                                                   ///< s
  double flow_gain = 2.36e-5 * 0.490 / 470;                                        ///< m^3/(s V sqrt(Pa))
  double internal_leakage = 1.724e-13;                                             ///< m^3/(s Pa)
  double external_leakage_1 = 2.401e-12, external_leakage_2 = 1.029e-13;           ///< m^3/(s Pa)
  double modulus_factor = 0.1972, modulus_rise = 124.368, modulus_shift = 26.814;  ///< a1, a2, a3; 1
  double bristle_stiffness = 97525.459;                                            ///< N/m
  double bristle_damping = 385.167, viscous_friction = 376.613;                    ///< N s/m
  double coulomb_friction = 247.804, static_friction = 7485.084;                   ///< N
  double stribeck_speed = 0.026318;                                                ///< m/s

  /// Pa: a1 E_max log10(a2 p / p_max + a3), E_max 1.8 GPa, p_max 28 MPa (equation 9).
  double BulkModulus(double pressure) const;
};

/// What is wrong with the axis, 0 = nothing; `hydroscope simulate flexible-axis --effect NAME=SIZE`.
struct FlexibleAxisFaults {
  double supply_drop = 0;          ///< Pa below the supply pressure
  double spool_zero = 0;           ///< V
  double spool_overlap = 0;        ///< V of command without flow, to either side
  double spring_loss = 0;          ///< 1, share of the spring's stiffness
  double load_friction = 0;        ///< N, Coulomb friction of the load's guide
  double retraction_friction = 0;  ///< N, more Coulomb friction while the rod moves in
  double free_air = 0;             ///< 1, share of the oil's volume at 1 bar
  double worn_edges = 0;           ///< V of opening that the closed edges keep
  double load_mass = 0;            ///< kg more
  double load_position_zero = 0;   ///< m
  double pressure_1_zero = 0;      ///< Pa
  double acceleration_zero = 0;    ///< m/s^2
};
struct FlexibleAxisFault {
  const char* id;
  double FlexibleAxisFaults::*size;
  double typical;  ///< clearly visible and plausible
  const char* unit;
  const char* meaning;
};
/// All of them, in the order of the documentation.
const std::vector<FlexibleAxisFault>& AllFlexibleAxisFaults();

/// Positions, speeds, pressures, spool (in volts of command that hold it there), bristle deflection.
struct FlexibleAxisState {
  double x_p = 0, v_p = 0, x_l = 0, v_l = 0, p_1 = 0, p_2 = 0, spool = 0, bristle = 0;
};

/// Equations 1 to 12 with flows that the spool switches, not the command, and fluid that leaves a chamber counted negative.
class FlexibleAxisPlant {
 public:
  FlexibleAxisPlant(const FlexibleAxisMachine& machine, const FlexibleAxisFaults& faults)
      : m_(machine), f_(faults) {}

  /// At rest with the piston at `position`, the forces on it in balance.
  FlexibleAxisState Rest(double position) const;
  /// Piston acceleration, m/s^2.
  double Acceleration(const FlexibleAxisState& s) const;
  /// `seconds` on with the command held, by Runge and Kutta's method of order 4 in steps short enough for the bristles.
  void Advance(double command, double seconds, FlexibleAxisState& s) const;

 private:
  using Rates = std::array<double, 8>;
  Rates RatesAt(const FlexibleAxisState& s, double command) const;
  double FrictionAtRest(double speed) const;
  double BristleRate(const FlexibleAxisState& s) const;
  double PressureRate(double pressure, double volume, double flow) const;
  double Opening(double spool) const;

  FlexibleAxisMachine m_;
  FlexibleAxisFaults f_;
};

}  // namespace hydroscope
