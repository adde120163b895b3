#include <fmt/format.h>

#include "models/machine_file/keys.h"
#include "models/machine_file/sections.h"
#include "models/machine_kind.h"

namespace hydroscope {
namespace {

/// ram_speed = { min = 20, max = 120, unit = "mm/s" }; either limit may be left out.
void ReadRange(TableReader& section, const StrokeSetting& setting, ExperimentSpec& spec) {
  const toml::table* table = section.Table(setting.key);
  if (table == nullptr) return;
  TableReader range(*table, fmt::format("{}.{}", section.path(), setting.key), section.problems());
  range.AllowOnly(MachineFileKeys("experiment.<range>"));
  std::string unit(setting.si);
  range.UnitName("unit", unit, setting.si);
  const Quantity quantity{.si = setting.si, .default_unit = unit, .low = 0, .above_low = true};
  ExperimentSpec::Limits& limits = spec.settings[std::string(setting.key)];
  range.Number("min", limits.min, quantity);
  range.Number("max", limits.max, quantity);
  if (limits.min && limits.max && *limits.min > *limits.max) range.Wrong("min", "a limit not above max");
}

/// warm_up = 15: the most that it may change by.
void ReadChange(TableReader& section, const StrokeSetting& setting, ExperimentSpec& spec) {
  double most = 0;
  section.Number(setting.key, most,
                 {.si = setting.si, .default_unit = setting.si, .difference = true, .low = 0});
  if (most > 0) spec.settings[std::string(setting.key)].max = most;
}

/// Whether what may be done to signals is named under `signals`.
bool NamesSignals(const MachineKind& kind) { return kind.own_library || kind.has_states; }

/// Settings of other kinds of machines.
void RefuseForeignSettings(TableReader& section, const MachineKind& kind) {
  for (const MachineKind* other : MachineKinds())
    for (const StrokeSetting& setting : other->experiment.settings)
      if (other != &kind && section.Has(setting.key))
        section.Problem(
            fmt::format("{} is for the {}{}", setting.key, other->title,
                        NamesSignals(kind) ? "; name the signals of this machine under signals" : ""));
}

}  // namespace

void ReadExperiment(TableReader& file, Machine& machine) {
  const toml::table* table = file.Table("experiment");
  if (table == nullptr) return;
  TableReader section(*table, "experiment", file.problems());
  section.AllowOnly(MachineFileKeys("experiment"));
  const MachineKind& kind = KindOf(machine);
  if (kind.experiment.on == nullptr && !NamesSignals(kind)) {
    section.Problem(fmt::format("nothing can be proposed to record on a {}", kind.title));
    return;
  }
  ExperimentSpec& spec = machine.experiment;
  std::vector<std::string> settings;
  for (const StrokeSetting& setting : kind.experiment.settings) {
    setting.range ? ReadRange(section, setting, spec) : ReadChange(section, setting, spec);
    settings.emplace_back(setting.key);
  }
  section.Integer("max_strokes", spec.max_strokes, 12);
  spec.signals = ReadBounds(section, "signals", "experiment.signals", machine);
  if (!NamesSignals(kind) && section.Has("signals"))
    section.Problem(
        fmt::format("signals is for machines of your own and those with states; here: {}", Listed(settings)));
  RefuseForeignSettings(section, kind);
  for (const GateBound& bound : spec.signals)
    if (bound.magnitude != bound.rate)
      section.Problem(
          fmt::format("signals: expected a signal (\"{0}\") or its speed (\"abs(ddt({0}))\")", bound.signal));
}

}  // namespace hydroscope
