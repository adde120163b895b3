#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/records/alarm_records.h"
#include "models/machine.h"
#include "workbench/history/stroke_history.h"

namespace hydroscope {

/// What speaks against taking strokes for those of the healthy machine.
struct LearningDoubt {
  enum class Kind {
    kModelVersions,  ///< they were recorded with more than one version of the model
    kOpenAlarm,      ///< an alarm about the machine stands and speaks of them
    kChange,         ///< the machine changed within them
    kImplausible,    ///< their sizes are none that such a machine has: a unit was wrong
    kReversed,       ///< a signal counted the other way round
    kTooSlow,        ///< their rows are too far apart to conclude anything from them
    kEffect,         ///< `explain` names an effect in them, or several it cannot tell apart
    kOddStrokes,     ///< a few of them differ from the others, which the model describes
    kUnexplained,    ///< `explain` says unknown: the model misses something, known or not
    kNotExplained,   ///< they could not be explained
  };
  Kind kind = Kind::kEffect;
  Told text;  ///< one sentence
  /// Of kUnexplained: a small error, one that may be noise, or one of a machine whose effects its user wrote.
  bool minor = false;
  /// Of strokes whose signals are worthless: the first stroke behind those seen to be, or 0.
  std::int64_t refused_to = 0;

  /// A model that is not perfect is no fault of the machine: the last two do not refuse.
  bool Refuses() const { return kind < Kind::kUnexplained; }
  /// A reference learned in spite of it is doubtful: what the model does not describe may be the fault that is sought.
  bool MakesDoubtful() const { return Refuses() || (kind == Kind::kUnexplained && !minor); }
};
/// "model_versions", "open_alarm", "change", "implausible", "reversed", "too_slow", "effect", "odd_strokes", "unexplained",
/// "not_explained".
const char* LearningDoubtName(LearningDoubt::Kind kind);

/// What makes the signals of the strokes of `part` worthless, whatever the model: kImplausible, kReversed or kTooSlow. Signs are
/// judged by what the stored estimates of a machine in closed loop say (ReversedIn), and of one with states by the rows kept of
/// its newest live strokes (JudgeSigns); its logs are judged before they are replayed.
std::optional<LearningDoubt> DoubtOfSignals(const Database& database, const std::string& path,
                                            const HistoryPart& part, const Machine& machine);

/// Looks at the strokes of `part` before they are learned: versions of the model, `alarms` of the machine, a
/// change inside (workbench/history/stored_change.h) and the verdict of the explain chain on all of them; where that is
/// unknown, also a parameter that moved or an error that grew over them (workbench/history/trend_analysis.h). Empty:
/// nothing speaks against it.
std::vector<LearningDoubt> DoubtsOfLearning(const Database& database, const std::string& path,
                                            const HistoryPart& part, const Machine& machine,
                                            const std::vector<AlarmState>& alarms);

/// The sentences of those that make a reference doubtful, or of all.
Told DoubtText(const std::vector<LearningDoubt>& doubts, bool doubtful_only);

}  // namespace hydroscope
