#include <fmt/format.h>

#include "models/machine_file/keys.h"
#include "models/machine_file/sections.h"
#include "models/machine_kind.h"

namespace hydroscope {
namespace {

/// ram_speed = { min = 20, max = 120, unit = "mm/s" }; either limit may be left out.
void ReadRange(TableReader& section, const char* key, const std::string& si, std::optional<double>& min,
               std::optional<double>& max) {
  const toml::table* table = section.Table(key);
  if (table == nullptr) return;
  TableReader range(*table, section.path() + "." + key, section.problems());
  range.AllowOnly(MachineFileKeys("experiment.<range>"));
  std::string unit = si;
  range.UnitName("unit", unit, si);
  const Quantity quantity{.si = si, .default_unit = unit, .low = 0, .above_low = true};
  range.Number("min", min, quantity);
  range.Number("max", max, quantity);
  if (min && max && *min > *max) range.Wrong("min", "a limit not above max");
}

}  // namespace

void ReadExperiment(TableReader& file, Machine& machine) {
  const toml::table* table = file.Table("experiment");
  if (table == nullptr) return;
  TableReader section(*table, "experiment", file.problems());
  section.AllowOnly(MachineFileKeys("experiment"));
  ExperimentSpec& spec = machine.experiment;
  ReadRange(section, "ram_speed", "m/s", spec.speed_min, spec.speed_max);
  ReadRange(section, "pressure", "Pa", spec.pressure_min, spec.pressure_max);
  ReadRange(section, "rod_pressure", "Pa", spec.rod_pressure_min, spec.rod_pressure_max);
  section.Number("warm_up", spec.warm_up, {.si = "K", .default_unit = "K", .difference = true, .low = 0});
  section.Integer("max_strokes", spec.max_strokes, 12);
  spec.signals = ReadBounds(section, "signals", "experiment.signals", machine);
  const bool own = KindOf(machine).own_library;
  if (!own && section.Has("signals"))
    section.Problem(
        "signals is for machines of your own; here: ram_speed, pressure, rod_pressure and warm_up");
  for (const char* key : {"ram_speed", "pressure", "rod_pressure", "warm_up"})
    if (own && section.Has(key))
      section.Problem(fmt::format(
          "{} is for the die cushion; name the signals of a machine of your own under signals", key));
  for (const GateBound& bound : spec.signals)
    if (bound.magnitude != bound.rate)
      section.Problem(
          fmt::format("signals: expected a signal (\"{0}\") or its speed (\"abs(ddt({0}))\")", bound.signal));
}

}  // namespace hydroscope
