#include <fmt/format.h>

#include "models/machine_file/keys.h"
#include "models/machine_file/sections.h"
#include "models/machine_kind.h"

namespace hydroscope {

void ReadEpisodeSection(TableReader& file, Machine& machine) {
  const toml::table* table = file.Table("episodes");
  if (table == nullptr) return;
  TableReader section(*table, "episodes", file.problems());
  section.AllowOnly(MachineFileKeys("episodes"));
  section.Number("seconds", machine.states.episode_seconds, kSecondsAboveZero);
  if (section.Has("seconds") && !InEpisodes(KindOf(machine)))
    section.Wrong("seconds", "no such key without [states]: write max_stroke in [gate]");
  section.Text("marker", machine.episode_marker);
  section.Text("shaft", machine.states.shaft);
  std::vector<std::string> names;
  for (const SignalSpec& signal : machine.signals) names.push_back(signal.name);
  if (section.Has("marker") && machine.SignalIndex(machine.episode_marker) < 0)
    section.Wrong("marker",
                  fmt::format("a signal of [signals] whose change begins a new episode; {}signals: {}",
                              DidYouMean(machine.episode_marker, names).english, Listed(names)));
  if (!section.Has("shaft")) return;
  const int shaft = machine.SignalIndex(machine.states.shaft);
  if (!KindOf(machine).has_states)
    section.Wrong("shaft", "no such key without [states]");
  else if (shaft < 0 || SiOf(machine.signals[static_cast<std::size_t>(shaft)].unit) != "rad/s")
    section.Wrong(
        "shaft",
        fmt::format("a signal of [signals] in rpm or rad/s, the speed of a shaft; {}signals: {}",
                    shaft < 0 ? DidYouMean(machine.states.shaft, names).english : "", Listed(names)));
}

}  // namespace hydroscope
