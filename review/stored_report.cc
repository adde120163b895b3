#include "review/stored_report.h"

#include <algorithm>

#include "core/told_error.h"
#include "models/counted_words.h"
#include "models/model_structure.h"
#include "report/drift_report.h"
#include "report/report.h"
#include "review/replay_report.h"
#include "review/stored_explanation.h"
#include "workbench/history/stored_change.h"
#include "workbench/history/stroke_history.h"

namespace hydroscope {
namespace {

/// The one machine that is meant.
Result<HistoryPart> Chosen(Database& database, const std::string& path, const std::string& machine) {
  auto parts = TRY(ChosenMachines(
      database, path, machine.empty() ? std::vector<std::string>{} : std::vector<std::string>{machine}));
  if (parts.size() == 1) return parts.front();
  std::string names;
  for (const HistoryPart& part : parts) names += (names.empty() ? "" : ", ") + part.machine;
  return UsageError("{} holds {} machines: {}. Choose one with --machine NAME", path, parts.size(), names);
}

}  // namespace

Result<StoredReport> WriteStoredReport(const std::string& path, const std::string& name,
                                       const std::string& page, const std::string& not_stored) {
  auto database = TRY(Database::OpenReadOnly(path));
  const auto part = TRY(Chosen(database, path, name));
  if (part.strokes() <= 0)
    return BadInput(Tell("{}: machine \"{}\" has no strokes yet", "{}: Maschine „{}“ hat noch keine Hübe",
                         path, part.machine));
  auto machine = TRY(StoredMachine(database, path, part));
  const auto model = TRY(BuildModel(machine));

  ReplayOutcome outcome;
  outcome.machine = std::move(machine);
  TRY(CollectOutcome(database, part.id, *model, outcome));
  auto input = TRY(MakeReportInput(database, part.id, outcome, {}));
  const std::vector<AlarmState> alarms = AlarmsBeside(path, part.machine);
  input.alarms = alarms;
  input.drift_verdict = NotStoredBox(not_stored) + AlarmsBox({}, alarms, CountedWordsOf(outcome.machine));
  if (!InEpisodes(KindOf(outcome.machine)))  // whose effects are tried on logs alone
    AddStoredExplanation(database, path, OfNewestVersion(part, input.runs), outcome.machine, input);
  TRY(WriteReport(page, input));
  const auto standing = std::ranges::count_if(alarms, [](const AlarmState& a) { return a.active; });
  return StoredReport{part.machine, part.strokes(), CountedWordsOf(outcome.machine), outcome.runs.size(),
                      standing};
}

}  // namespace hydroscope
