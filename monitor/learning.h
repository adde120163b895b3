#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "monitor/axis_monitor.h"
#include "monitor/learning_check.h"

namespace hydroscope {

/// Strokes that are to be learned as those of the healthy machine, and what speaks against it.
struct LearningCandidate {
  Machine machine;  ///< by the name it has in the database
  HistoryPart part;
  std::vector<LearningDoubt> doubts;

  bool Refused() const;
};

/// Looks at the strokes of `part` (DoubtsOfLearning). Error: the journal cannot be read.
Result<LearningCandidate> LookBeforeLearning(const Database& database, const std::string& path,
                                             const Machine& machine, const HistoryPart& part,
                                             const AlarmJournal& journal);

/// Freezes them as the next reference of their machine (AxisMonitor::Learn): `machine`, `reference_version`, `first_stroke`,
/// `last_stroke`, `operating_classes`, `doubts`, `curves`. `wall` in s since 1970.
Result<nlohmann::json> LearnReference(const Database& database, const std::string& path,
                                      const LearningCandidate& candidate, const drift::RuleBook& rules,
                                      AlarmJournal& journal, const AlarmUser& user, double wall);

/// `kind`, `text`, `refuses` of each.
nlohmann::json DoubtsJson(const std::vector<LearningDoubt>& doubts);

/// The journal beside the database at `path`, to be written; one of another database is set aside, which `note` then tells.
Result<AlarmJournal> OpenJournalOf(const std::string& path, double wall, std::string& note);

}  // namespace hydroscope
