#include "cli/alarms_learning.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "live/service_socket.h"
#include "monitor/axis_monitor.h"
#include "monitor/rules_for.h"
#include "workbench/history/stroke_history.h"

namespace hydroscope {
namespace {

/// By the built-in rules: which rules file somebody keeps beside a machine file no database knows.
Result<LearningMachine> LearningByRules(Database& database, const std::string& path, AlarmJournal& journal,
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
  const Health health = axis.JudgedHealth();
  learning.learned = health.learned;
  learning.needed = health.needed;
  learning.counted = axis.counted().Many().english;
  return learning;
}

}  // namespace

Result<std::vector<LearningMachine>> LearningOf(Database& database, const std::string& path,
                                                AlarmJournal& journal,
                                                const std::vector<std::string>& machines) {
  std::vector<LearningMachine> all;
  if (machines.empty()) return all;
  const auto answer = AskService(SocketOf(path), "GET", "/status");
  const auto status = answer ? nlohmann::json::parse(*answer, nullptr, false) : nlohmann::json();
  for (const std::string& machine : machines) {
    auto learning = TRY(LearningByRules(database, path, journal, machine));
    if (status.is_object() && status.contains("drift"))
      for (const nlohmann::json& axis : status["drift"].value("axes", nlohmann::json::array()))
        if (axis.value("name", "") == machine) {
          learning.by_service = true;
          learning.learned = axis.value("commissioning_strokes", learning.learned);
          learning.needed = axis.value("commissioning_needed", learning.needed);
        }
    all.push_back(std::move(learning));
  }
  return all;
}

std::string LearningText(const LearningMachine& learning) {
  if (learning.needed == 0) return learning.machine;
  return fmt::format("{}, {} of {} {}{}", learning.machine, learning.learned, learning.needed,
                     learning.counted.empty() ? "strokes" : learning.counted,
                     learning.by_service ? "" : " by the built-in rules");
}

}  // namespace hydroscope
