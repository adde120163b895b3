#include "storage/alarm_journal.h"

#include <fmt/ranges.h>
#include <sqlite3.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <sstream>

#include "core/contains.h"
#include "core/told_error.h"
#include "storage/connection.h"

namespace hydroscope {
namespace {

constexpr const char* kJournalTables = R"sql(
CREATE TABLE journal(
  sequence INTEGER PRIMARY KEY,
  machine TEXT NOT NULL,
  wall_s REAL NOT NULL,
  time_s REAL,
  stroke INTEGER NOT NULL,
  alarm TEXT NOT NULL,
  event TEXT NOT NULL,
  state_before TEXT NOT NULL,
  state TEXT NOT NULL,
  severity TEXT NOT NULL,
  value REAL,
  std REAL,
  limit_value REAL,
  unit TEXT NOT NULL,
  oil_temperature_K REAL,
  model_version INTEGER NOT NULL,
  reference_version INTEGER NOT NULL,
  user TEXT NOT NULL,
  comment TEXT NOT NULL,
  text TEXT NOT NULL,
  first_stroke INTEGER NOT NULL,
  last_stroke INTEGER NOT NULL
) STRICT;
CREATE TRIGGER journal_is_not_changed BEFORE UPDATE ON journal BEGIN SELECT RAISE(ABORT, 'the journal is append-only'); END;
CREATE TRIGGER journal_is_not_deleted BEFORE DELETE ON journal BEGIN SELECT RAISE(ABORT, 'the journal is append-only'); END;

CREATE TABLE alarm(
  machine TEXT NOT NULL,
  id TEXT NOT NULL,
  severity TEXT NOT NULL,
  active INTEGER NOT NULL,
  acknowledged INTEGER NOT NULL,
  latched INTEGER NOT NULL,
  out_of_service INTEGER NOT NULL,
  suppressed INTEGER NOT NULL,
  shelved_until_s REAL,
  on_count INTEGER NOT NULL,
  off_count INTEGER NOT NULL,
  value REAL,
  std REAL,
  limit_value REAL,
  unit TEXT NOT NULL,
  text TEXT NOT NULL,
  raised_time_s REAL,
  raised_wall_s REAL,
  raised_stroke INTEGER NOT NULL,
  first_stroke INTEGER NOT NULL,
  last_stroke INTEGER NOT NULL,
  PRIMARY KEY(machine, id)
) STRICT, WITHOUT ROWID;

CREATE TABLE monitor(
  machine TEXT PRIMARY KEY,
  next_stroke INTEGER NOT NULL,
  model_version INTEGER NOT NULL,
  state BLOB NOT NULL
) STRICT;

CREATE TABLE reference(
  machine TEXT NOT NULL,
  version INTEGER NOT NULL,
  first_stroke INTEGER NOT NULL,
  last_stroke INTEGER NOT NULL,
  wall_s REAL NOT NULL,
  bytes BLOB NOT NULL,
  PRIMARY KEY(machine, version)
) STRICT;
)sql";

/// Causes of alarms, and the database the journal belongs to.
constexpr const char* kJournalVersion2 = R"sql(
ALTER TABLE journal ADD COLUMN cause TEXT NOT NULL DEFAULT '';
ALTER TABLE alarm ADD COLUMN cause_kind INTEGER NOT NULL DEFAULT 0;
ALTER TABLE alarm ADD COLUMN cause_effects TEXT NOT NULL DEFAULT '';
CREATE TABLE pairing(database TEXT NOT NULL) STRICT;
)sql";

/// What an alarm says, apart and in German.
constexpr const char* kJournalVersion3 = R"sql(
ALTER TABLE alarm ADD COLUMN finding TEXT NOT NULL DEFAULT '';
ALTER TABLE alarm ADD COLUMN finding_german TEXT NOT NULL DEFAULT '';
ALTER TABLE alarm ADD COLUMN evidence TEXT NOT NULL DEFAULT '';
ALTER TABLE alarm ADD COLUMN evidence_german TEXT NOT NULL DEFAULT '';
ALTER TABLE alarm ADD COLUMN action TEXT NOT NULL DEFAULT '';
ALTER TABLE alarm ADD COLUMN action_german TEXT NOT NULL DEFAULT '';
)sql";

/// What alarms speak of.
constexpr const char* kJournalVersion4 = "ALTER TABLE alarm ADD COLUMN quantities TEXT NOT NULL DEFAULT '';";

/// Element i brings version i to version i + 1; version 0 is an empty file.
constexpr std::array<const char*, kJournalFormat> kJournalMigrations = {kJournalTables, kJournalVersion2,
                                                                        kJournalVersion3, kJournalVersion4};

constexpr const char* kRowColumns =
    "sequence, machine, wall_s, time_s, stroke, alarm, event, state_before, state, severity, value, std, "
    "limit_value, unit, oil_temperature_K, model_version, reference_version, user, comment, text, "
    "first_stroke, last_stroke, cause";

Status CheckKind(SQLite::Database& db, const std::string& path) {
  const int application = db.execAndGet("PRAGMA application_id").getInt();
  const int version = db.execAndGet("PRAGMA user_version").getInt();
  if (application != kJournalApplicationId)
    return BadInput(
        Tell("{} is no alarm journal (application id {:#x}, expected {:#x}); it was left as it is",
             "{} ist kein Alarmjournal (application id {:#x}, erwartet {:#x}); es wurde gelassen, wie es war",
             path, static_cast<unsigned>(application), static_cast<unsigned>(kJournalApplicationId)));
  if (version > kJournalFormat)
    return BadInput(Tell(
        "{} has journal format {}, this program knows formats up to {}; use the hydroscope that wrote it",
        "{} hat das Journalformat {}, dieses Programm kennt Formate bis {}; das hydroscope benutzen, das es schrieb",
        path, version, kJournalFormat));
  return {};
}

Status Prepare(SQLite::Database& db, const std::string& path) {
  const bool fresh = db.execAndGet("SELECT count(*) FROM sqlite_master").getInt() == 0 &&
                     db.execAndGet("PRAGMA application_id").getInt() == 0;
  if (!fresh) TRY(CheckKind(db, path));
  db.exec("PRAGMA journal_mode = WAL");
  db.exec("PRAGMA synchronous = NORMAL");  // what tells of alarms waits for the disk by itself
  const auto version = [&] { return db.execAndGet("PRAGMA user_version").getInt(); };
  if (version() == kJournalFormat) return {};
  SQLite::Transaction transaction(db, SQLite::TransactionBehavior::IMMEDIATE);
  for (int from = version(); from < kJournalFormat; ++from)  // another process may have been faster
    db.exec(kJournalMigrations[from]);
  db.exec(fmt::format("PRAGMA application_id = {}", kJournalApplicationId));
  db.exec(fmt::format("PRAGMA user_version = {}", kJournalFormat));
  transaction.commit();
  return {};
}

/// Waits until the disk has what was committed, as `synchronous = FULL` would at every commit.
Status WaitForDisk(Connection& connection) {
  sqlite3_file* log = nullptr;
  sqlite3_file_control(connection.db.getHandle(), "main", SQLITE_FCNTL_JOURNAL_POINTER, &log);
  if (log == nullptr || log->pMethods == nullptr ||
      log->pMethods->xSync(log, SQLITE_SYNC_NORMAL) == SQLITE_OK)
    return {};
  return InternalError(Tell("{}: the disk does not take what is written",
                            "{}: die Platte nimmt nicht an, was geschrieben wird", connection.path));
}

AlarmSeverity Severity(const std::string& name) {
  return SeverityFromName(name).value_or(AlarmSeverity::kWarning);
}

std::vector<std::string> SplitNames(const std::string& listed) {
  std::vector<std::string> names;
  std::istringstream stream(listed);
  for (std::string name; std::getline(stream, name, ',');) names.push_back(name);
  return names;
}

std::vector<AlarmState> LoadAlarms(Connection& connection, const std::string& machine) {
  Query query(
      connection,
      "SELECT id, severity, active, acknowledged, latched, out_of_service, suppressed, "
      "shelved_until_s, on_count, off_count, value, std, limit_value, unit, text, raised_time_s, "
      "raised_wall_s, raised_stroke, first_stroke, last_stroke, cause_kind, cause_effects, "
      "finding, finding_german, evidence, evidence_german, action, action_german, quantities FROM alarm "
      "WHERE machine = ? ORDER BY id",
      machine);
  std::vector<AlarmState> alarms;
  while (query.Step()) {
    AlarmState a;
    std::string severity;
    query.Read(0, a.id, severity, a.active, a.acknowledged, a.latched, a.out_of_service, a.suppressed);
    a.severity = Severity(severity);
    if (!query.IsNull(7)) a.shelved_until = query.Real(7);
    query.Read(8, a.on_count, a.off_count, a.value, a.std, a.limit, a.unit, a.text, a.raised_time,
               a.raised_wall, a.raised_stroke, a.first_stroke, a.last_stroke);
    a.cause = {static_cast<CauseKind>(std::clamp<std::int64_t>(
                   query.Int(20), 0, static_cast<std::int64_t>(CauseKind::kNotProven))),
               SplitNames(query.Text(21))};
    a.words = {
        {query.Text(22), query.Text(23)}, {query.Text(24), query.Text(25)}, {query.Text(26), query.Text(27)}};
    a.quantities = SplitNames(query.Text(28));
    alarms.push_back(std::move(a));
  }
  return alarms;
}

void StoreAlarm(Connection& connection, const std::string& machine, const AlarmState& a) {
  const double shelved = a.shelved_until.value_or(std::numeric_limits<double>::quiet_NaN());
  Query(connection,
        "INSERT OR REPLACE INTO alarm VALUES(?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, "
        "?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)",
        machine, a.id, SeverityName(a.severity), a.active, a.acknowledged, a.latched, a.out_of_service,
        a.suppressed, shelved, a.on_count, a.off_count, a.value, a.std, a.limit, a.unit, a.text,
        a.raised_time, a.raised_wall, a.raised_stroke, a.first_stroke, a.last_stroke,
        static_cast<int>(a.cause.kind), fmt::format("{}", fmt::join(a.cause.effects, ",")),
        a.words.finding.english, a.words.finding.german, a.words.evidence.english, a.words.evidence.german,
        a.words.action.english, a.words.action.german, fmt::format("{}", fmt::join(a.quantities, ",")))
      .Run();
}

StoredMonitor LoadMonitor(Connection& connection, const std::string& machine) {
  Query query(connection, "SELECT next_stroke, model_version, state FROM monitor WHERE machine = ?", machine);
  if (!query.Step()) return {};
  return {query.Int(0), static_cast<int>(query.Int(1)), query.Bytes(2)};
}

std::int64_t NewestSequence(Connection& connection) {
  Query query(connection, "SELECT coalesce(max(sequence), 0) FROM journal");
  query.Step();
  return query.Int(0);
}

void AppendRow(Connection& connection, std::int64_t sequence, const std::string& machine, double wall,
               const AlarmEvent& e) {
  Query(connection,
        "INSERT INTO journal VALUES(?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)",
        sequence, machine, wall, e.time, e.stroke, e.alarm, e.event, e.state_before, e.state,
        SeverityName(e.severity), e.value, e.std, e.limit, e.unit, e.oil_temperature, e.model_version,
        e.reference_version, e.user, e.comment, e.text, e.first_stroke, e.last_stroke, e.cause)
      .Run();
}

JournalRow ReadRow(const Query& q) {
  JournalRow row;
  AlarmEvent& e = row.event;
  std::string severity;
  q.Read(0, row.sequence, row.machine, row.wall, e.time, e.stroke, e.alarm, e.event, e.state_before, e.state,
         severity, e.value, e.std, e.limit, e.unit, e.oil_temperature, e.model_version, e.reference_version,
         e.user, e.comment, e.text, e.first_stroke, e.last_stroke, e.cause);
  e.severity = Severity(severity);
  return row;
}

Status Exists(const std::string& path) {
  std::error_code ignored;
  if (std::filesystem::exists(path, ignored)) return {};
  return BadInput(Tell(
      "there is no alarm journal {}; `hydroscope replay LOG --machine M.toml "
      "--db D` writes it beside the database D",
      "es gibt kein Alarmjournal {}; `hydroscope replay LOG --machine M.toml --db D` schreibt es neben die Datenbank D",
      path));
}

/// A journal of the present format.
Status CheckJournalForReading(SQLite::Database& db, const std::string& path) {
  TRY(CheckKind(db, path));
  if (db.execAndGet("PRAGMA user_version").getInt() == kJournalFormat) return {};
  return BadInput(Tell("{} has an older journal format and is not migrated",
                       "{} hat ein älteres Journalformat und ist nicht umgestellt", path));
}

}  // namespace

struct AlarmJournal::Impl : Connection {
  using Connection::Connection;
};

AlarmState& AxisContent::Alarm(const std::string& id) {
  const auto at = std::ranges::lower_bound(alarms, id, {}, &AlarmState::id);
  if (at != alarms.end() && at->id == id) return *at;
  AlarmState alarm;
  alarm.id = id;
  return *alarms.insert(at, std::move(alarm));
}

void AxisContent::Append(std::vector<AlarmEvent> more) {
  events.insert(events.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
}

AlarmJournal::AlarmJournal(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
AlarmJournal::AlarmJournal(AlarmJournal&&) noexcept = default;
AlarmJournal& AlarmJournal::operator=(AlarmJournal&&) noexcept = default;
AlarmJournal::~AlarmJournal() = default;

std::string AlarmJournal::PathFor(const std::string& database) { return PathBeside(database, "alarms"); }

Result<AlarmJournal> AlarmJournal::Open(const std::string& path) {
  auto impl = TRY(OpenOrMake<Impl>(path, Prepare));
  return AlarmJournal(std::move(impl));
}

Result<AlarmJournal> AlarmJournal::OpenExisting(const std::string& path) {
  TRY(Exists(path));
  return Open(path);
}

Result<AlarmJournal> AlarmJournal::OpenReadOnly(const std::string& path) {
  TRY(Exists(path));
  auto impl = OpenForReading<Impl>(path, CheckJournalForReading);
  // One of an older format: whoever may write brings it to the present one.
  if (!impl) return Open(path);
  return AlarmJournal(std::move(*impl));
}

Result<std::string> AlarmJournal::DatabaseIdentity() const {
  return Guarded(impl_->path, &impl_->db, [&]() -> Result<std::string> {
    Query query(*impl_, "SELECT database FROM pairing");
    return query.Step() ? query.Text(0) : std::string();
  });
}

Status AlarmJournal::SetDatabaseIdentity(const std::string& identity) {
  return Guarded(impl_->path, &impl_->db, [&]() -> Status {
    SQLite::Transaction transaction(impl_->db, SQLite::TransactionBehavior::IMMEDIATE);
    Query(*impl_, "DELETE FROM pairing").Run();
    Query(*impl_, "INSERT INTO pairing VALUES(?)", identity).Run();
    transaction.commit();
    return WaitForDisk(*impl_);
  });
}

Status AlarmJournal::Change(const std::string& machine, double wall,
                            const std::function<Status(AxisContent&)>& change) {
  return Guarded(impl_->path, &impl_->db, [&]() -> Status {
    SQLite::Transaction transaction(impl_->db, SQLite::TransactionBehavior::IMMEDIATE);
    AxisContent content{LoadAlarms(*impl_, machine), LoadMonitor(*impl_, machine), {}, {}};
    const AxisContent before = content;
    TRY(change(content));
    for (const AlarmState& alarm : content.alarms)
      if (!Contains(before.alarms, alarm)) StoreAlarm(*impl_, machine, alarm);
    if (content.monitor.next_stroke != before.monitor.next_stroke ||
        content.monitor.state != before.monitor.state)
      Query(*impl_, "INSERT OR REPLACE INTO monitor VALUES(?, ?, ?, ?)", machine, content.monitor.next_stroke,
            content.monitor.model_version, content.monitor.state)
          .Run();
    for (const StoredReference& r : content.references)
      Query(*impl_, "INSERT INTO reference VALUES(?, ?, ?, ?, ?, ?)", machine, r.version, r.first_stroke,
            r.last_stroke, wall, r.bytes)
          .Run();
    std::int64_t sequence = content.events.empty() ? 0 : NewestSequence(*impl_);
    for (const AlarmEvent& event : content.events) AppendRow(*impl_, ++sequence, machine, wall, event);
    transaction.commit();
    // How far strokes are judged is found again; what was told of an alarm, and what was learned, is not.
    const bool must_last = !content.events.empty() || !content.references.empty();
    return must_last ? WaitForDisk(*impl_) : Status{};
  });
}

Result<AlarmJournal::Version> AlarmJournal::CurrentVersion() const {
  return Guarded(impl_->path, &impl_->db, [&]() -> Result<Version> {
    Query others(*impl_, "PRAGMA data_version");  // of commits by other connections
    others.Step();
    return Version{others.Int(0), sqlite3_total_changes(impl_->db.getHandle())};
  });
}

std::int64_t AlarmJournal::PagesAsked() const { return impl_->PagesFound() + impl_->PagesRead(); }

Result<std::vector<std::string>> AlarmJournal::Machines() const {
  return Guarded(impl_->path, &impl_->db, [&]() -> Result<std::vector<std::string>> {
    Query query(*impl_,
                "SELECT machine FROM monitor UNION SELECT machine FROM alarm UNION "
                "SELECT machine FROM journal ORDER BY 1");
    std::vector<std::string> names;
    while (query.Step()) names.push_back(query.Text(0));
    return names;
  });
}

Result<AxisContent> AlarmJournal::Axis(const std::string& machine) const {
  return Guarded(impl_->path, &impl_->db, [&]() -> Result<AxisContent> {
    return AxisContent{LoadAlarms(*impl_, machine), LoadMonitor(*impl_, machine), {}, {}};
  });
}

Result<std::vector<JournalRow>> AlarmJournal::Rows(const std::string& machine, std::int64_t after,
                                                   std::int64_t limit) const {
  return Guarded(impl_->path, &impl_->db, [&]() -> Result<std::vector<JournalRow>> {
    static const std::string sql = fmt::format(
        "SELECT {} FROM journal WHERE sequence > ?1 AND (?2 = '' OR machine = ?2) ORDER BY sequence LIMIT ?3",
        kRowColumns);
    Query query(*impl_, sql.c_str(), after, machine, limit > 0 ? limit : std::int64_t{-1});
    std::vector<JournalRow> rows;
    while (query.Step()) rows.push_back(ReadRow(query));
    return rows;
  });
}

Result<std::int64_t> AlarmJournal::LastSequence() const {
  return Guarded(impl_->path, &impl_->db, [&]() -> Result<std::int64_t> { return NewestSequence(*impl_); });
}

Result<std::vector<std::pair<std::string, std::string>>> AlarmJournal::AlarmsByAppearance() const {
  using Alarms = std::vector<std::pair<std::string, std::string>>;
  return Guarded(impl_->path, &impl_->db, [&]() -> Result<Alarms> {
    Query query(*impl_,
                "SELECT machine, alarm FROM journal WHERE alarm <> '' GROUP BY "
                "machine, alarm ORDER BY min(sequence)");
    Alarms alarms;
    while (query.Step()) alarms.emplace_back(query.Text(0), query.Text(1));
    return alarms;
  });
}

Result<std::optional<StoredReference>> AlarmJournal::LatestReference(const std::string& machine) const {
  return Guarded(impl_->path, &impl_->db, [&]() -> Result<std::optional<StoredReference>> {
    Query query(*impl_,
                "SELECT version, first_stroke, last_stroke, bytes FROM reference WHERE "
                "machine = ? ORDER BY version DESC LIMIT 1",
                machine);
    if (!query.Step()) return std::nullopt;
    return StoredReference{static_cast<int>(query.Int(0)), query.Int(1), query.Int(2), query.Bytes(3)};
  });
}

Status AlarmJournal::CheckIntegrity() const {
  return Guarded(impl_->path, &impl_->db, [&]() -> Status {
    const std::string pages = impl_->db.execAndGet("PRAGMA integrity_check").getString();
    if (pages != "ok")
      return BadInput(Tell("{} is damaged: {}", "{} ist beschädigt: {}", impl_->path, pages));
    Query query(*impl_,
                "SELECT count(*), coalesce(max(sequence), 0), coalesce(min(sequence), 1) FROM journal");
    query.Step();
    if (query.Int(0) != query.Int(1) || query.Int(2) != 1)
      return BadInput(Tell("{}: the journal has {} rows up to number {}: rows are missing",
                           "{}: das Journal hat {} Zeilen bis zur Nummer {}: es fehlen Zeilen", impl_->path,
                           query.Int(0), query.Int(1)));
    return {};
  });
}

}  // namespace hydroscope
