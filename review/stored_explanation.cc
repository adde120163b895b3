#include "review/stored_explanation.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/shell_word.h"
#include "models/counted_words.h"
#include "report/error_words.h"
#include "report/explain_report.h"
#include "workbench/explain/explain_stored.h"

namespace hydroscope {

HistoryPart OfNewestVersion(HistoryPart part, const std::vector<RunInfo>& runs) {
  const RunInfo* newest = nullptr;
  for (const RunInfo& run : runs)
    if (run.strokes > 0 && run.first_sequence < part.last) newest = &run;
  if (newest == nullptr) return part;
  for (const RunInfo& run : runs)
    if (run.first_sequence < part.last && run.model_version != newest->model_version)
      part.first = std::max(part.first, run.first_sequence + run.strokes);
  return part;
}

std::string WhichStrokes(const ReportInput& report, const HistoryPart& part) {
  if (VersionsOf(report.runs).size() < 2) return "";
  return fmt::format("This is about {} {} to {}, of the version of the model that is in force.",
                     CountedWordsOf(report.machine).many, part.first, part.last - 1);
}

void AddStoredExplanation(const Database& database, const std::string& path, const HistoryPart& part,
                          const Machine& machine, ReportInput& report) {
  auto stored = ExplainStored(database, path, part, machine, report.alarms);
  if (!stored) return;
  stored->now().target = "--db " + ShellWord(path);
  const std::string which = WhichStrokes(report, part),
                    change = ChangeSentence(*stored, CountedWordsOf(machine));
  AddExplanation(stored->now(), which.empty() || change.empty() ? which + change : which + " " + change,
                 report);
}

}  // namespace hydroscope
