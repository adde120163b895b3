#pragma once

#include <optional>
#include <string>

#include "storage/alarm_journal.h"
#include "storage/database.h"

namespace hydroscope {

/// A journal that did not belong to the database, and where it is now.
struct SetAsideJournal {
  std::string path;
  std::int64_t rows = 0;      ///< of the journal
  std::int64_t standing = 0;  ///< alarms that were not at rest
};
/// "the alarm journal belonged to another database; it is kept as press.alarms.20261122T101500Z.db (35 rows,
/// 2 alarms stood)".
std::string SetAsideText(const SetAsideJournal& journal);

/// Sees to it that the journal beside `database` (at `path`) is its own, for those who are about to write it:
/// one without a database is taken over, unless it has judged strokes that the database does not have; one of
/// another database is set aside under a name with the date `wall` (s since 1970), with the feeds' outbox,
/// which counts its rows, and another one is begun, whose first row, `journal_set_aside` of machine `press`,
/// tells it. Nobody else may have them open. nullopt: it was its own, or there was none. Errors: files cannot
/// be read or renamed.
Result<std::optional<SetAsideJournal>> PairJournal(Database& database, const std::string& path,
                                                   const std::string& press, double wall);

}  // namespace hydroscope
