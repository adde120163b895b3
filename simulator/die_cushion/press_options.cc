#include "simulator/die_cushion/press_options.h"

#include <fmt/ranges.h>

#include <cmath>

#include "core/units.h"
#include "simulator/die_cushion/effects.h"
#include "simulator/die_cushion/imperfections.h"
#include "simulator/die_cushion/sensors.h"
#include "simulator/ranges.h"

namespace hydroscope {
namespace {

Status CheckFaults(const std::vector<SensorFault>& faults) {
  for (const SensorFault& fault : faults) {
    if (!ChannelIndex(fault.channel)) {
      const std::vector<std::string> names(kPressChannels.begin(), kPressChannels.end());
      return UsageError("fault on unknown channel '{}'; the log has {}", fault.channel,
                        fmt::join(names, ", "));
    }
    if (!(fault.start >= 0) || !(fault.duration >= 0) || !std::isfinite(fault.size))
      return UsageError("fault of {} at {} s for {} s: start and duration must be 0 s or more", fault.channel,
                        fault.start, fault.duration);
  }
  return {};
}

}  // namespace

Status Validate(const PressOptions& o) {
  const PressMachine& m = o.machine;
  const PressMotion& w = o.motion;
  TRY(CheckRanges({
      {"seconds", o.seconds, 0.1, 1e8, "s"},
      {"sample_period", o.sample_period, 1e-5, 0.1, "s"},
      {"control_period", o.control_period, 1e-5, 0.1, "s"},
      {"max_step", o.max_step, 1e-7, 2e-4, "s"},
      {"oil temperature at the start", o.oil_start, 253.15, 393.15, "K"},
      {"oil temperature at the end", o.oil_end, 253.15, 393.15, "K"},
      {"bulk modulus K", m.K, 1e8, 3e9, "Pa"},
      {"volume V0", m.V0, 1e-5, 1, "m3"},
      {"area A_A", m.A_A, 1e-5, 1, "m2"},
      {"nominal flow Q_vn", m.Q_vn, 1e-6, 1, "m3/s"},
      {"nominal pressure drop dp_nom", m.dp_nom, 1e4, 5e7, "Pa"},
      {"spool zero y_0", m.y_0, -0.5, 0.5, "1"},
      {"supply pressure", m.p_supply, m.p_tank + 1e5, 1e8, "Pa"},
      {"tank pressure", m.p_tank, -0.9e5, 1e8, "Pa"},
      {"valve frequency", m.valve_f0, 5, 2000, "Hz"},
      {"valve damping", m.valve_damping, 0.05, 5, "1"},
      {"valve gain", m.valve_gain, 0.1, 10, "1"},
      {"valve dead time", m.valve_dead_time, 0, 0.05, "s"},
      {"lowest ram speed", w.speed_min, 1e-4, 1, "m/s"},
      {"highest ram speed", w.speed_max, w.speed_min, 1, "m/s"},
      {"return speed", w.return_speed, 1e-4, 1, "m/s"},
      {"lower end z_bottom", w.z_bottom - w.z_bottom_spread, 0, w.z_top, "m"},
      {"ramp_time", w.ramp_time, 1e-3, (w.z_top - w.z_bottom - w.z_bottom_spread) / w.speed_max, "s"},
      {"shortest dwell", w.dwell_min, 0, 1e6, "s"},
      {"longest dwell", w.dwell_max, w.dwell_min, 1e6, "s"},
      {"lowest set point", w.set_point_min, 1e5, 1e8, "Pa"},
      {"highest set point", w.set_point_max, w.set_point_min, 1e8, "Pa"},
      {"shortest set point step", w.step_time_min, 1e-3, 1e6, "s"},
      {"longest set point step", w.step_time_max, w.step_time_min, 1e6, "s"},
      {"rest pressure", w.rest_pressure, 1e5, m.p_supply - 1e5, "Pa"},
  }));
  for (const double speed : w.speeds)
    TRY(CheckRanges({{"ram speed in turn", speed, 1e-4, w.speed_max, "m/s"}}));
  for (const double level : w.set_points) TRY(CheckRanges({{"set point in turn", level, 1e5, 1e8, "Pa"}}));
  for (const double level : w.rod_pressures)
    TRY(CheckRanges({{"rod pressure in turn", level, 0, 1e8, "Pa"}}));
  TRY(ResolveEffects(o.effects));
  TRY(ResolveImperfections(o.imperfections));
  return CheckFaults(o.faults);
}

}  // namespace hydroscope
