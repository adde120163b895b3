#include "workbench/explain/explain_stored.h"

#include <fmt/format.h>

#include "models/machine_kind.h"
#include "pipeline/run_summary.h"
#include "workbench/history/history_output.h"

namespace hydroscope {
namespace {

/// Of the sides of StoredExplanation::change.
Status Compare(const Database& database, const std::string& path, const HistoryPart& part,
               const Machine& machine, StoredExplanation& out) {
  HistoryPart before = part, after = part;
  before.last = out.change->before_end;
  after.first = out.change->since;
  auto then = TRY(LoadHistory(database, path, {before}, machine));
  auto now = TRY(LoadHistory(database, path, {after}, machine));
  auto sides = TRY(ExplainChange(then, now));
  sides.before.described = HistoryLine(then);
  sides.after.described = HistoryLine(now);
  out.before = std::move(then);
  out.after = std::move(now);
  out.sides = std::move(sides);
  return {};
}

/// Strokes that no effect explains as one, as a number of the model moves on over them: the newest against the first if explained.
void CompareEnds(const Database& database, const std::string& path, const HistoryPart& part,
                 const Machine& machine, StoredExplanation& out) {
  Explanation& whole = out.whole->explanation;
  if (out.change || whole.verdict != Verdict::kUnknown || !whole.no_verdict.empty() ||
      KindOf(machine).has_states)
    return;
  StoredExplanation ends;
  ends.change = FindMovingOn(database, part, machine);
  if (!ends.change) return;
  const bool named = Compare(database, path, part, machine, ends).has_value() &&
                     ends.sides->after.explanation.verdict != Verdict::kUnknown &&
                     ends.sides->before.explanation.verdict != Verdict::kUnknown;
  if (named) {
    out = std::move(ends);
    return;
  }
  whole.warnings.push_back(WarningOfBothSides(*ends.change, CountedWordsOf(machine)));
}

}  // namespace

Result<StoredExplanation> ExplainStored(const Database& database, const std::string& path,
                                        const HistoryPart& part, const Machine& machine,
                                        const std::vector<AlarmState>& alarms) {
  StoredExplanation out;
  out.change = FindStoredChange(database, part, machine, alarms);
  if (out.change) {
    if (const auto log = LogThatBegins(database, part, *out.change))
      out.begins = AnotherMachineText(*log, CountedWordsOf(machine)).english;
    const Status compared = Compare(database, path, part, machine, out);
    if (compared) return out;
    out.not_compared = compared.error().text;
  }
  auto history = TRY(LoadHistory(database, path, {part}, machine));
  auto result = TRY(ExplainHistoryButForOdd(history));
  result.described = HistoryLine(history);
  out.after = std::move(history);
  out.whole = std::move(result);
  CompareEnds(database, path, part, machine, out);
  return out;
}

std::string ChangeSentence(const StoredExplanation& explanation, const CountedWords& counted) {
  if (!explanation.change) return "";
  std::string sentence =
      fmt::format("These {} hold a change {}.", counted.many, explanation.change->text.english);
  if (!explanation.begins.empty()) sentence += fmt::format(" {}.", explanation.begins);
  if (explanation.sides) return sentence;
  return sentence +
         fmt::format(" They could not be compared ({}); explained as one, so before and after are mixed.",
                     explanation.not_compared);
}

}  // namespace hydroscope
