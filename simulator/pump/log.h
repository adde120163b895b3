#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "core/result.h"
#include "simulator/pump/plant.h"

namespace hydroscope {

/// How the pump is driven; `hydroscope simulate pump --manoeuvre NAME`.
enum class PumpManoeuvre { kLevels, kStep, kPulse };
struct PumpManoeuvreInfo {
  const char* name;
  PumpManoeuvre manoeuvre;
  const char* meaning;
};
const std::vector<PumpManoeuvreInfo>& AllPumpManoeuvres();

/// Standard deviations of the sensors, and lag of the flow sensor. Converters average from row to row.
struct PumpSensors {
  double pressure = 2e4;   ///< Pa
  double position = 1e-5;  ///< m
  double flow = 2e-6;      ///< m^3/s
  double speed = 0.2;      ///< rad/s
  double flow_lag = 5e-3;  ///< s, time constant
};

struct PumpOptions {
  PumpMachine machine;
  PumpFaults faults;
  PumpSensors sensors;
  PumpManoeuvre manoeuvre = PumpManoeuvre::kLevels;
  double seconds = 6;
  double period = 2.5e-4;     ///< s
  double speed = 390;         ///< rad/s
  double speed_swing = 0.15;  ///< share of the speed that it wanders by
  double ripple = 1;          ///< of the pistons, relative to the usual
  double wear = 0;            ///< 1/s, by which the leakage of the control chamber grows ...
  double wear_from = 0;       ///< s, from then on
  std::uint64_t seed = 1;     ///< of noise, levels and pistons
};
/// Names field, value and limit.
Status Validate(const PumpOptions& options);

/// A pump drawn at random: what is identified within a factor of 1.23 of the usual sizes to either side, flow sensor lag 2 to 20 ms.
PumpOptions RandomPump(std::uint64_t seed);

/// A size by its name, SI.
using PumpSize = std::pair<std::string, double>;
/// What a fit of the pump should find.
std::vector<PumpSize> TrueParameters(const PumpOptions& options);

struct PumpLog {
  std::vector<double> t;  ///< s
  /// rad/s, m^3/s, Pa, Pa, m as measured.
  std::vector<double> speed, flow, p_s, p_c, x_p;
  std::vector<PumpState> truth;
  std::vector<double> ripple;  ///< Pa, what of p_s is that of the pistons
  double RippleRms() const;    ///< Pa
};
/// `options` must pass Validate().
PumpLog SimulatePump(const PumpOptions& options);

/// Header and lines t,n,Q,p_s,p_c,x_p in SI.
std::string FormatPump(const PumpLog& log);

}  // namespace hydroscope
