// The [live] part of a machine file, and where each signal comes from; what each source's section holds stands in its folder.
#include <set>

#include "models/ipv4_range.h"
#include "models/machine_file/keys.h"
#include "models/machine_file/section_text.h"
#include "models/machine_file/sections.h"
#include "models/source_kind.h"

namespace hydroscope {

void CheckAddressRanges(TableReader& section, const char* key, const std::vector<std::string>& ranges) {
  for (const std::string& range : ranges)
    if (!ParseIpv4Range(range))
      section.Wrong(key, fmt::format("addresses and networks such as \"192.168.0.7\" and "
                                     "\"192.168.0.0/24\"; \"{}\" is neither",
                                     range));
}

namespace {

void ReadAxes(TableReader& section, std::vector<std::string>& axes) {
  section.Texts("axes", axes);
  const std::set<std::string> once(axes.begin(), axes.end());
  if (once.size() != axes.size()) section.Wrong("axes", "every axis only once");
  for (const std::string& axis : axes)
    if (axis.empty() || axis.find_first_of("/{}\n") != std::string::npos)
      section.Wrong("axes", "names without /, { and }, e.g. [\"cushion_1\", \"cushion_2\"]");
}

/// "dds, modbus", "dds or modbus".
std::string SourceNames(const char* separator) {
  std::string names;
  for (const SourceKind* kind : SourceKinds())
    names += (names.empty() ? "" : separator) + std::string(kind->name);
  return names;
}

}  // namespace

void ReadSignalOrigin(TableReader& signal, SignalSpec& spec) {
  for (const SourceKind* kind : SourceKinds()) {
    if (!signal.Has(kind->name)) continue;
    if (spec.origin)
      signal.Problem(
          fmt::format("has both {} and {}; a signal comes from one place", spec.origin->part(), kind->name));
    spec.origin = kind->read_origin(signal);
  }
}

void ReadLive(TableReader& file, Machine& machine) {
  const toml::table* table = file.Table("live");
  if (table == nullptr) return;
  LiveSpec& live = machine.live.emplace();
  TableReader section(*table, "live", file.problems());
  section.AllowOnly(MachineFileKeys("live"));
  section.Number("grid_period", live.grid_period, kSecondsAboveZero);
  ReadAxes(section, live.axes);
  for (const SourceKind* kind : SourceKinds())
    if (const toml::table* own = section.Table(kind->name)) {
      const std::string path = fmt::format("live.{}", kind->name);
      TableReader reader(*own, path, file.problems());
      reader.AllowOnly(MachineFileKeys(path));
      live.sources.settings.emplace(kind->name, kind->read(reader));
    }
}

void CheckLive(TableReader& file, const Machine& machine) {
  for (const SignalSpec& signal : machine.signals) {
    if (!signal.origin) {
      if (machine.live && signal.required)
        file.Problem(
            fmt::format("[signals.{}] has neither {}, but the machine is [live]; say where it comes from, or "
                        "required = false",
                        signal.name, SourceNames(" nor ")));
      continue;
    }
    const SourceKind& kind = *FindSourceKind(signal.origin->part());
    if (!machine.live || !machine.live->sources.settings.contains(kind.name))
      file.Problem(
          fmt::format("[signals.{}] {} needs a section [live.{}]", signal.name, kind.name, kind.name));
    else if (kind.check != nullptr)
      kind.check(file, machine, signal);
  }
}

std::string LiveSections(const Machine& machine, const MachineNotes& notes) {
  if (!machine.live) return "";
  const LiveSpec& live = *machine.live;
  std::string text =
      Section("[live]", "The machine as it is watched live.",
              {{"grid_period", Plain(live.grid_period)}, {"axes", QuotedList(live.axes)}}, notes, "live");
  for (const SourceKind* kind : SourceKinds())
    if (const auto at = live.sources.settings.find(kind->name); at != live.sources.settings.end()) {
      const std::string name = fmt::format("live.{}", kind->name);
      text += Section("[" + name + "]", std::string(kind->comment), kind->write(at->second), notes, name);
    }
  return text;
}

}  // namespace hydroscope
