#include "storage/journal_pairing.h"

#include <algorithm>

#include "storage/outbox.h"
#include "storage/set_aside.h"

namespace hydroscope {
namespace {

/// It has judged strokes, or learned from strokes, that the database does not hold.
Result<bool> IsAhead(const AlarmJournal& journal, Database& database) {
  const auto known = database.MachineNames();
  if (!known) return tl::unexpected(known.error());
  const auto machines = journal.Machines();
  if (!machines) return tl::unexpected(machines.error());
  for (const std::string& machine : *machines) {
    const auto axis = journal.Axis(machine);
    if (!axis) return tl::unexpected(axis.error());
    if (axis->monitor.next_stroke == 0) continue;
    std::int64_t end = 0;
    if (std::ranges::find(*known, machine) != known->end()) {
      const auto id = database.MachineId(machine);
      const auto stored = id ? database.EndSequence(*id) : Result<std::int64_t>(tl::unexpected(id.error()));
      if (!stored) return tl::unexpected(stored.error());
      end = *stored;
    }
    if (axis->monitor.next_stroke > end) return true;
  }
  return false;
}

Result<SetAsideJournal> Counted(const AlarmJournal& journal) {
  SetAsideJournal counted;
  const auto rows = journal.LastSequence();
  if (!rows) return tl::unexpected(rows.error());
  counted.rows = *rows;
  const auto machines = journal.Machines();
  if (!machines) return tl::unexpected(machines.error());
  for (const std::string& machine : *machines) {
    const auto axis = journal.Axis(machine);
    if (!axis) return tl::unexpected(axis.error());
    counted.standing += std::ranges::count_if(
        axis->alarms, [](const AlarmState& a) { return std::string(StateName(a)) != "NORM"; });
  }
  return counted;
}

/// nullopt: the journal is the database's own from now on.
Result<std::optional<SetAsideJournal>> TakeOverOrCount(Database& database, AlarmJournal& journal,
                                                       const std::string& identity) {
  const auto known = journal.DatabaseIdentity();
  if (!known) return tl::unexpected(known.error());
  if (*known == identity) return std::nullopt;
  if (known->empty()) {
    const auto ahead = IsAhead(journal, database);
    if (!ahead) return tl::unexpected(ahead.error());
    if (!*ahead) {
      if (const Status set = journal.SetDatabaseIdentity(identity); !set) return tl::unexpected(set.error());
      return std::nullopt;
    }
  }
  auto counted = Counted(journal);
  if (!counted) return tl::unexpected(counted.error());
  return std::move(*counted);
}

/// A journal of `identity` that tells what was set aside.
Status Begin(const std::string& path, const std::string& identity, const std::string& press,
             const SetAsideJournal& aside, double wall) {
  auto journal = AlarmJournal::Open(path);
  if (!journal) return tl::unexpected(journal.error());
  if (const Status set = journal->SetDatabaseIdentity(identity); !set) return set;
  return journal->Change(press, wall, [&](AxisContent& content) -> Status {
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
  const auto identity = database.Identity();
  if (!identity) return tl::unexpected(identity.error());
  const std::string journal_path = AlarmJournal::PathFor(path), outbox_path = Outbox::PathFor(path);
  std::optional<SetAsideJournal> aside;
  {
    auto journal = AlarmJournal::Open(journal_path);
    if (!journal) return tl::unexpected(journal.error());
    auto counted = TakeOverOrCount(database, *journal, *identity);
    if (!counted || !*counted) return counted;
    aside = std::move(*counted);
  }
  auto moved = SetAside(journal_path, wall);
  if (!moved) return tl::unexpected(moved.error());
  aside->path = std::move(*moved);
  if (const auto outbox = SetAside(outbox_path, wall); !outbox) return tl::unexpected(outbox.error());
  if (const Status begun = Begin(journal_path, *identity, press, *aside, wall); !begun)
    return tl::unexpected(begun.error());
  return aside;
}

}  // namespace hydroscope
