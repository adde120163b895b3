#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace hydroscope {

/// A pressure-compensated axial-piston pump (paper: docs/pump.md). Set point, full flow and speed are published; all other sizes
/// are chosen so that droop, control flow and natural frequencies are those of a pump of that size.
struct PumpMachine {
  double preload = 1017;         ///< N, of the compensator spring: area times 203.4 bar
  double spring = 2.4e5;         ///< N/m, of the compensator, K_v
  double flow_gain = 0.55;       ///< m^2/s at `gain_drop` over an edge, K_q
  double leakage = 1.7e-11;      ///< m^3/(s Pa), of the control chamber, C_l
  double piston_spring = 1.5e5;  ///< N/m, of the control piston, K_p
  double line_volume = 5e-3;     ///< m^3, V_t
  double spool_area = 5e-5;      ///< m^2, A_v
  double piston_area = 1.77e-4;  ///< m^2, A_p
  double spool_mass = 0.1;       ///< kg
  double piston_mass = 1.5;      ///< kg, with what of the swash plate it moves
  double spool_damping = 300;    ///< N s/m
  double piston_damping = 1200;  ///< N s/m
  double chamber_volume = 2e-5;  ///< m^3, of the control chamber at full displacement
  double modulus = 1.2e9;        ///< Pa
  double displacement = 4.6e-6;  ///< m^3/rad, largest
  double piston_stroke = 0.012;  ///< m, to no displacement
  double spool_stroke = 1e-3;    ///< m, to either side
  double tank_pressure = 2e5;    ///< Pa
  double gain_drop = 1e7;        ///< Pa, that flow_gain is stated at
  double edge_rounding = 2e-6;   ///< m, of the metering edges
  double dry_speed = 1e-2;       ///< m/s, over which dry friction sets in
  int pistons = 9;
};

/// What is wrong with the pump, 0 = nothing; `hydroscope simulate pump --effect NAME=SIZE`.
struct PumpFaults {
  double leakage_grown = 0;  ///< m^3/(s sqrt(Pa)), a scored gap beside the laminar one of the control chamber
  double sticking_spool = 0;  ///< N, dry friction of the compensator spool
  double weak_spring = 0;     ///< 1, share of the spring's stiffness lost beyond kCrackOpens
  double suction_air = 0;     ///< 1, share of each stroke that is filled with air
  double swash_bearing = 0;   ///< N, dry friction that the control piston feels
  double outlet_leakage = 0;  ///< m^3/(s Pa), out of the line
};
struct PumpFault {
  const char* id;
  double PumpFaults::*size;
  double typical;  ///< clearly visible and plausible
  const char* unit;
  const char* meaning;
};
/// All of them, in the order of the documentation.
const std::vector<PumpFault>& AllPumpFaults();

/// Pressures (Pa), control piston and spool (m, m/s), angle of the shaft (rad).
struct PumpState {
  double p_c = 0, p_s = 0, x_p = 0, v_p = 0, x_v = 0, v_v = 0, angle = 0;
};

/// What drives the pump at an instant.
struct PumpDrive {
  double speed = 0;        ///< rad/s
  double conductance = 0;  ///< m^3/(s sqrt(Pa)), of the load's orifice
  double preload = 0;      ///< N
  double wear = 1;         ///< factor of the control chamber's leakage
};

/// Flow of the pistons over the mean, about 0 on a revolution: half sines of pistons that are not quite alike, and the flow back
/// into each as it opens to the outlet (Ivantysyn and Ivantysynova 2001, ch. 4).
class PistonRipple {
 public:
  PistonRipple(int pistons, std::uint64_t seed);
  double At(double angle) const;

 private:
  std::vector<double> at_;  ///< at equal angles over a revolution, the first once more at the end
};

class PumpPlant {
 public:
  PumpPlant(const PumpMachine& machine, const PumpFaults& faults, double ripple, std::uint64_t seed)
      : m_(machine), f_(faults), line_impedance_(ripple * kLineImpedance), ripple_(machine.pistons, seed) {}

  /// At rest under a drive, the ripple left out.
  PumpState Rest(const PumpDrive& drive) const;
  /// One step by Runge and Kutta's method of order 4, the drive held; keeps piston and spool between their stops.
  void Step(const PumpDrive& drive, double seconds, PumpState& s) const;
  /// Pa; what the pistons' flow adds to the line's pressure at the outlet.
  double Ripple(const PumpDrive& drive, const PumpState& s) const;
  /// m^3/s, through the load.
  double LoadFlow(const PumpDrive& drive, double outlet_pressure) const;

  static constexpr double kCrackOpens = 1e-4;    ///< m of deflection from which on a cracked coil gives way
  static constexpr double kLineImpedance = 5e9;  ///< Pa s/m^3, wave impedance of the outlet line

 private:
  using Rates = std::array<double, 6>;
  Rates RatesAt(const PumpState& s, const PumpDrive& d, double ripple) const;
  void Stop(PumpState& s) const;

  PumpMachine m_;
  PumpFaults f_;
  double line_impedance_;
  PistonRipple ripple_;
};

}  // namespace hydroscope
