#pragma once

#include <string>
#include <vector>

#include "core/result.h"
#include "storage/alarm_journal.h"
#include "storage/database.h"

namespace hydroscope {

/// How far a machine is that is not judged yet, since the healthy one is being learned.
struct LearningMachine {
  std::string machine;
  std::int64_t learned = 0, needed = 0;  ///< 0 needed: not known
  std::string counted;                   ///< "strokes"
  bool recorded = false;  ///< by whoever judged the strokes; else counted by the built-in rules
};

/// The same of these machines of the database at `path`.
Result<std::vector<LearningMachine>> LearningOf(Database& database, const std::string& path,
                                                AlarmJournal& journal,
                                                const std::vector<std::string>& machines);

/// "die_cushion, 19 of 1500 strokes".
std::string LearningText(const LearningMachine& learning);

}  // namespace hydroscope
