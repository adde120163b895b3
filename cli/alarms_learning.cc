#include "cli/alarms_learning.h"

#include <fmt/format.h>

#include "monitor/axis_monitor.h"
#include "monitor/rules_for.h"
#include "workbench/history/stroke_history.h"

namespace hydroscope {
namespace {

Result<LearningMachine> LearningOfOne(Database& database, const std::string& path, AlarmJournal& journal,
                                      const std::string& name) {
  LearningMachine learning;
  learning.machine = name;
  const auto parts = TRY(ChosenMachines(database, path, {name}));
  if (parts.front().strokes() == 0) return learning;
  auto machine = TRY(StoredMachine(database, path, parts.front()));
  machine.name = name;
  const auto model = TRY(BuildModel(machine));
  const auto rules = TRY(RulesFor("", machine));
  AxisMonitor axis(machine, model, rules, database, path, parts.front().id, journal);
  if (!axis.Look()) return learning;
  learning.learned = axis.commissioning_strokes();
  learning.needed = axis.commissioning_needed();
  learning.recorded = axis.commissioning_recorded();
  learning.counted = axis.counted().Many().english;
  return learning;
}

}  // namespace

Result<std::vector<LearningMachine>> LearningOf(Database& database, const std::string& path,
                                                AlarmJournal& journal,
                                                const std::vector<std::string>& machines) {
  std::vector<LearningMachine> all;
  for (const std::string& machine : machines)
    all.push_back(TRY(LearningOfOne(database, path, journal, machine)));
  return all;
}

std::string LearningText(const LearningMachine& learning) {
  if (learning.needed == 0) return learning.machine;
  return fmt::format("{}, {} of {} {}{}", learning.machine, learning.learned, learning.needed,
                     learning.counted.empty() ? "strokes" : learning.counted,
                     learning.recorded ? "" : " by the built-in rules");
}

}  // namespace hydroscope
