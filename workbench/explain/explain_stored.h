#pragma once

#include <optional>
#include <string>
#include <vector>

#include "workbench/explain/explain_change.h"
#include "workbench/history/stored_change.h"

namespace hydroscope {

/// What stored strokes of one machine say: as one, or, where they hold a change, those after it against those before.
struct StoredExplanation {
  std::optional<StoredChange> change;  ///< that they hold
  std::string not_compared;            ///< why they are explained as one in spite of it
  std::string begins;    ///< of logs, the one that begins where the change is, a sentence; "": none does
  StrokeHistory before;  ///< empty where they are explained as one
  StrokeHistory after;   ///< or all of them
  std::optional<ChangeResult> sides;
  std::optional<ExplainResult> whole;  ///< in place of `sides`

  /// Of the strokes as they are now.
  ExplainResult& now() { return sides ? sides->after : *whole; }
};

/// Explains what the model of `machine` misses on the strokes of `part`; `alarms` are those of the machine. The results say what
/// they describe (ExplainResult::described). Errors as LoadHistory, ExplainHistory.
Result<StoredExplanation> ExplainStored(const Database& database, const std::string& path,
                                        const HistoryPart& part, const Machine& machine,
                                        const std::vector<AlarmState>& alarms);

/// "These strokes hold a change since stroke 110, told by the alarm internal_leakage."; "" without one.
std::string ChangeSentence(const StoredExplanation& explanation, const CountedWords& counted);

}  // namespace hydroscope
