#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "core/result.h"
#include "simulator/die_cushion/press_options.h"

namespace hydroscope {

/// A further number of an effect.
struct EffectExtra {
  std::string name;
  double value;      ///< default
  std::string unit;  ///< SI
};

/// What can be hidden in a simulated press.
struct EffectInfo {
  std::string id;
  std::string unit;     ///< SI unit of the size
  double typical_size;  ///< a clearly visible, plausible size
  std::string law;      ///< one line
  std::vector<EffectExtra> extras;
};

/// All effects in the order of the documentation.
const std::vector<EffectInfo>& PressEffects();

/// Sizes and extras of all effects as plain numbers; 0 = absent. The laws below read nothing else.
struct PressEffectSizes {
  double internal_leakage = 0;
  double external_leakage = 0;
  double orifice_leakage = 0;
  double air_fraction = 0, air_exponent = 1.4;
  double accumulator = 0, accumulator_precharge = 80e5, accumulator_exponent = 1.3;
  double relief_gain = 0, relief_crack = 180e5;
  double tank_resistance = 0;
  double curvature = 0, curvature_normal_opening = 0.3;
  double asymmetry = 0;
  double overlap = 0;
  double hysteresis = 0;
  double viscosity = 0, viscosity_reference = 313.15;
  double pressure_offset = 0;
  double spool_delay = 0, pressure_delay = 0, position_delay = 0;
  double worn_leakage = 0, worn_centre = 0.11, worn_width = 0.02;
  double inertance = 0;
};

/// Reads the settings; an unknown id or extra is an error that suggests the nearest known one.
Result<PressEffectSizes> ResolveEffects(const std::vector<EffectSetting>& settings);

inline constexpr double kAtmosphere = 1.01325e5;  ///< Pa, absolute pressure at 0 gauge
inline constexpr double kAirReference = 1e5;      ///< Pa absolute, at which the free-air fraction is stated

/// Square root with the sign of its argument; linear within some 0.2 bar of 0, as an orifice is at low
/// Reynolds numbers, so that the equation stays integrable: x / (x^2 + d^2)^(1/4).
inline double SignedRoot(double x) {
  constexpr double kLaminar = 2e4;  // Pa
  return x / std::sqrt(std::sqrt(x * x + kLaminar * kLaminar));
}

/// Leakage out of chamber A, m^3/s: laminar to the rod side, laminar to outside, turbulent to the rod side, a
/// worn zone of the bore, and a relief valve.
double LeakageFlow(const PressEffectSizes& e, double p_A, double p_B, double z);

/// Hydraulic capacity of chamber A, m^3/Pa: oil with entrained air in `volume`, and a gas-charged
/// accumulator. Oil and air share the pressure: 1/K_eff = (1-x)/K + x/(n p_abs), with the share of the volume
/// that is air x = a r / (1 - a + a r), r = (1 bar / p_abs)^(1/n). Accumulator above its pre-charge: V_gas =
/// V (p_pre/p)^(1/n).
double ChamberCapacity(const PressEffectSizes& e, double bulk_modulus, double volume, double p_A);

/// Position of the metering edge when the spool is at `spool` and the edge was at `edge`: play of the given width.
double EdgeWithPlay(const PressEffectSizes& e, double spool, double edge);

/// Opening that meters, from the opening y_v - y_0: overlap, then curvature, then other gain of the edge y <
/// 0.
double EffectiveOpening(const PressEffectSizes& e, double opening);

/// Flow gain relative to that at the reference temperature.
double ViscosityGain(const PressEffectSizes& e, double oil_temperature);

}  // namespace hydroscope
