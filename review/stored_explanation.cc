#include "review/stored_explanation.h"

#include <fmt/format.h>

#include "core/shell_word.h"
#include "models/counted_words.h"
#include "report/explain_report.h"
#include "workbench/explain/explain_stored.h"

namespace hydroscope {

void AddStoredExplanation(const Database& database, const std::string& path, const HistoryPart& part,
                          const Machine& machine, ReportInput& report) {
  auto stored = ExplainStored(database, path, part, machine, report.alarms);
  if (!stored) return;
  stored->now().target = "--db " + ShellWord(path);
  AddExplanation(stored->now(), ChangeSentence(*stored, CountedWordsOf(machine)), report);
}

}  // namespace hydroscope
