#include "studies/simulated_strokes.h"

#include <map>
#include <string_view>

#include "acquisition/quality_monitor.h"
#include "pipeline/log_faults/physical_sizes.h"
#include "replay/held_signals.h"
#include "replay/time_check.h"

namespace hydroscope {

Machine MachineFor(const PressOptions& options) {
  Machine machine;
  machine.name = "simulated_cushion";
  const auto signal = [&](const char* name, const char* unit, double stuck_time, bool required) {
    SignalSpec spec;
    spec.name = spec.column = name;
    spec.unit = unit;
    spec.stuck_time = stuck_time;
    spec.required = required;
    machine.signals.push_back(spec);
  };
  signal("p_A", "Pa", 0.1, true);
  signal("p_B", "Pa", 0.1, false);
  signal("p_0", "Pa", 0.1, false);
  signal("z", "m", 0.1, true);
  signal("y_v", "1", 0.1, true);
  signal("U_v", "V", 0, false);
  signal("T_oil", "K", 0, false);
  machine.geometry["A_A"] = {options.machine.A_A, 0};
  machine.geometry["dp_nom"] = {options.machine.dp_nom, 0};
  machine.geometry["p_t"] = {options.machine.p_tank, 0};
  machine.geometry["stroke"] = {options.motion.z_top, 0};
  machine.gate.bounds = {{"y_v", false, 0.04, std::nullopt}, {"z", true, std::nullopt, -0.004}};
  return machine;
}

SampleBlock RowsOf(const SimulatedLog& log, const Machine& machine) {
  SampleBlock rows;
  rows.Resize(machine.signals.size(), log.rows());
  rows.time = log.t;
  const std::map<std::string_view, const std::vector<double>*> columns = {
      {"p_A", &log.p_A}, {"p_B", &log.p_B}, {"p_0", &log.p_0},    {"z", &log.z},
      {"y_v", &log.y_v}, {"U_v", &log.U_v}, {"T_oil", &log.T_oil}};
  for (std::size_t s = 0; s < machine.signals.size(); ++s)
    rows.signal[s] = *columns.at(machine.signals[s].name);
  return rows;
}

Result<LogStrokes> StrokesOf(const SimulatedLog& log, const Machine& machine, KeepSamples keep,
                             const Pipeline::EquationTap& tap) {
  const double period = log.truth.options.sample_period;
  StrokeCollector collector(machine, keep);
  auto pipeline = TRY(Pipeline::Create(machine, period, collector.Sink()));
  pipeline->set_tap(keep == KeepSamples::kYes ? collector.Tap() : tap);
  SampleBlock rows = RowsOf(log, machine);
  if (const auto held = FindHeldSignals(rows, machine)) DrawHeldSignals(*held, rows);
  LogCounters counters;
  TimeChecker(period).Check(rows, counters);
  SizeWatch sizes(machine, period);
  sizes.Observe(rows);
  TRY(sizes.Judge());
  QualityMonitor monitor(machine, period);
  monitor.Inspect(rows);
  pipeline->Process(rows);
  monitor.Flush(rows);
  pipeline->Process(rows);
  pipeline->Finish();
  return collector.Finish(*pipeline);
}

}  // namespace hydroscope
