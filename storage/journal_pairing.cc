#include "storage/journal_pairing.h"

#include <algorithm>

#include "core/contains.h"
#include "storage/outbox.h"
#include "storage/set_aside.h"

namespace hydroscope {
namespace {

/// It has judged strokes, or learned from strokes, that the database does not hold.
Result<bool> IsAhead(const AlarmJournal& journal, Database& database) {
  const auto known = TRY(database.MachineNames());
  const auto machines = TRY(journal.Machines());
  for (const std::string& machine : machines) {
    const auto axis = TRY(journal.Axis(machine));
    if (axis.monitor.next_stroke == 0) continue;
    std::int64_t end = 0;
    if (Contains(known, machine)) {
      const auto id = database.MachineId(machine);
      end = TRY(id ? database.EndSequence(*id) : Result<std::int64_t>(tl::unexpected(id.error())));
    }
    if (axis.monitor.next_stroke > end) return true;
  }
  return false;
}

Result<SetAsideJournal> Counted(const AlarmJournal& journal) {
  SetAsideJournal counted;
  counted.rows = TRY(journal.LastSequence());
  const auto machines = TRY(journal.Machines());
  for (const std::string& machine : machines) {
    const auto axis = TRY(journal.Axis(machine));
    counted.standing += std::ranges::count_if(
        axis.alarms, [](const AlarmState& a) { return std::string(StateName(a)) != "NORM"; });
  }
  return counted;
}

/// nullopt: the journal is the database's own from now on.
Result<std::optional<SetAsideJournal>> TakeOverOrCount(Database& database, AlarmJournal& journal,
                                                       const std::string& identity) {
  const auto known = TRY(journal.DatabaseIdentity());
  if (known == identity) return std::nullopt;
  if (known.empty()) {
    const auto ahead = TRY(IsAhead(journal, database));
    if (!ahead) {
      TRY(journal.SetDatabaseIdentity(identity));
      return std::nullopt;
    }
  }
  auto counted = TRY(Counted(journal));
  return counted;
}

/// A journal of `identity` that tells what was set aside.
Status Begin(const std::string& path, const std::string& identity, const std::string& press,
             const SetAsideJournal& aside, double wall) {
  auto journal = TRY(AlarmJournal::Open(path));
  TRY(journal.SetDatabaseIdentity(identity));
  return journal.Change(press, wall, [&](AxisContent& content) -> Status {
    AlarmEvent event;
    event.event = "journal_set_aside";
    event.text = SetAsideText(aside);
    content.events.push_back(std::move(event));
    return {};
  });
}

}  // namespace

std::string SetAsideText(const SetAsideJournal& journal) {
  return fmt::format(
      "the alarm journal beside the database belonged to another database; it is kept as {} ({} row{}, {} "
      "alarm{} stood), and a new one is begun: nothing is inherited from it",
      journal.path, journal.rows, journal.rows == 1 ? "" : "s", journal.standing,
      journal.standing == 1 ? "" : "s");
}

Result<std::optional<SetAsideJournal>> PairJournal(Database& database, const std::string& path,
                                                   const std::string& press, double wall) {
  const auto identity = TRY(database.Identity());
  const std::string journal_path = AlarmJournal::PathFor(path), outbox_path = Outbox::PathFor(path);
  std::optional<SetAsideJournal> aside;
  {
    auto journal = TRY(AlarmJournal::Open(journal_path));
    auto counted = TakeOverOrCount(database, journal, identity);
    if (!counted || !*counted) return counted;
    aside = std::move(*counted);
  }
  aside->path = TRY(SetAside(journal_path, wall));
  TRY(SetAside(outbox_path, wall));
  TRY(Begin(journal_path, identity, press, *aside, wall));
  return aside;
}

}  // namespace hydroscope
