#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "core/result.h"
#include "simulator/flexible_axis/plant.h"

namespace hydroscope {

/// How the axis is driven; `hydroscope simulate flexible-axis --manoeuvre NAME`.
enum class AxisManoeuvre { kStep, kNegativeStep, kLargeStep, kRamp, kNoisySine, kStaircase, kClosedLoop };
struct AxisManoeuvreInfo {
  const char* name;
  AxisManoeuvre manoeuvre;
  const char* meaning;
};
const std::vector<AxisManoeuvreInfo>& AllAxisManoeuvres();

/// Standard deviations of the five sensors, and what may be wrong with them.
struct AxisSensors {
  double position = 1e-4;      ///< m
  double acceleration = 0.05;  ///< m/s^2
  double pressure = 0.3e5;     ///< Pa
  double filter = 0;           ///< Hz, corner of a first-order low-pass before each converter; 0 = none
  int bits = 0;                ///< of the converters; 0 = no steps
  double coloured = 0;         ///< how much of the noise remembers itself from row to row, 0 ... 1
};

struct FlexibleAxisOptions {
  FlexibleAxisMachine machine;
  FlexibleAxisFaults faults;
  AxisSensors sensors;
  AxisManoeuvre manoeuvre = AxisManoeuvre::kStep;
  int rows = 4113;         ///< of the paper's record
  double period = 1e-3;    ///< s
  std::uint64_t seed = 1;  ///< of noise and of what is random in a manoeuvre
};
/// Names field, value and limit.
Status Validate(const FlexibleAxisOptions& options);

/// A machine drawn at random: sizes that the paper identifies within a factor of 2 of its own, the bristles' stiffness
/// between 1e5 and 1e7 N/m.
FlexibleAxisMachine RandomFlexibleAxis(std::uint64_t seed);

/// A size by its name, SI.
using NamedSize = std::pair<std::string, double>;
/// What a fit of the machine should find: nominal flow at 10 V and 35 bar, static friction beyond the sliding one, bulk modulus
/// at three pressures.
std::vector<NamedSize> TrueParameters(const FlexibleAxisMachine& machine);
std::vector<NamedSize> NoiseOf(const AxisSensors& sensors);

struct FlexibleAxisLog {
  std::vector<double> t;  ///< s
  /// V; m, m, m/s^2, Pa, Pa as measured.
  std::vector<double> U, x_p, x_l, a_p, p_1, p_2;
  std::vector<FlexibleAxisState> truth;
};
/// `options` must pass Validate(). The command is held from row to row, and 0 outwards beyond the limit switches 0.05 m from
/// either end.
FlexibleAxisLog SimulateFlexibleAxis(const FlexibleAxisOptions& options);

/// Header and lines t,U,x_p,x_l,a_p,p_1,p_2 in SI.
std::string FormatFlexibleAxis(const FlexibleAxisLog& log);

}  // namespace hydroscope
