#include "storage/outbox.h"

#include "storage/connection.h"

namespace hydroscope {
namespace {

constexpr const char* kOutboxTables = R"sql(
CREATE TABLE item(
  sequence INTEGER PRIMARY KEY,
  topic TEXT NOT NULL,
  payload BLOB NOT NULL
) STRICT;
CREATE TABLE progress(
  only INTEGER PRIMARY KEY CHECK(only = 1),
  cursor INTEGER NOT NULL,
  births INTEGER NOT NULL
) STRICT;
INSERT INTO progress VALUES(1, 0, 0);
)sql";

Status PrepareOutbox(SQLite::Database& db, const std::string& path) {
  db.exec("PRAGMA journal_mode = WAL");
  db.exec("PRAGMA synchronous = NORMAL");
  SQLite::Transaction transaction(db, SQLite::TransactionBehavior::IMMEDIATE);
  const int application = db.execAndGet("PRAGMA application_id").getInt();
  const int version = db.execAndGet("PRAGMA user_version").getInt();
  const bool fresh = application == 0 && db.execAndGet("SELECT count(*) FROM sqlite_master").getInt() == 0;
  if (!fresh && application != kOutboxApplicationId)
    return BadInput("{} is no outbox (application id {:#x}, expected {:#x}); it was left as it is", path,
                    static_cast<unsigned>(application), static_cast<unsigned>(kOutboxApplicationId));
  if (!fresh && version != kOutboxFormat)
    return BadInput("{} has outbox format {}, this program knows format {}; use the hydroscope that wrote it",
                    path, version, kOutboxFormat);
  if (fresh) {
    db.exec(kOutboxTables);
    db.exec(fmt::format("PRAGMA application_id = {}", kOutboxApplicationId));
    db.exec(fmt::format("PRAGMA user_version = {}", kOutboxFormat));
  }
  transaction.commit();
  return {};
}

std::int64_t CursorOf(Connection& connection) {
  Query query(connection, "SELECT cursor FROM progress");
  query.Step();
  return query.Int(0);
}

}  // namespace

struct Outbox::Impl : Connection {
  using Connection::Connection;
};

Outbox::Outbox(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Outbox::Outbox(Outbox&&) noexcept = default;
Outbox& Outbox::operator=(Outbox&&) noexcept = default;
Outbox::~Outbox() = default;

std::string Outbox::PathFor(const std::string& database) { return PathBeside(database, "outbox"); }

Result<Outbox> Outbox::Open(const std::string& path) {
  auto impl = TRY(OpenOrMake<Impl>(path, PrepareOutbox));
  return Outbox(std::move(impl));
}

Result<std::int64_t> Outbox::Cursor() const {
  return Guarded(impl_->path, &impl_->db, [&]() -> Result<std::int64_t> { return CursorOf(*impl_); });
}

Status Outbox::Put(const std::vector<OutboxItem>& items, std::int64_t cursor) {
  return Guarded(impl_->path, &impl_->db, [&]() -> Status {
    SQLite::Transaction transaction(impl_->db, SQLite::TransactionBehavior::IMMEDIATE);
    std::int64_t last = CursorOf(*impl_);
    for (const OutboxItem& item : items) {
      if (item.sequence <= last)
        return InternalError("{}: item {} comes after {}; another service fills this outbox", impl_->path,
                             item.sequence, last);
      last = item.sequence;
      Query(*impl_, "INSERT INTO item VALUES(?, ?, ?)", item.sequence, item.topic,
            std::vector<std::uint8_t>(item.payload.begin(), item.payload.end()))
          .Run();
    }
    if (cursor < last) return InternalError("{}: cursor {} lies before item {}", impl_->path, cursor, last);
    Query(*impl_, "UPDATE progress SET cursor = ?", cursor).Run();
    transaction.commit();
    return {};
  });
}

Result<std::vector<OutboxItem>> Outbox::Items(std::int64_t after, std::int64_t limit) const {
  return Guarded(impl_->path, &impl_->db, [&]() -> Result<std::vector<OutboxItem>> {
    Query query(*impl_,
                "SELECT sequence, topic, payload FROM item WHERE sequence > ? ORDER BY sequence LIMIT ?",
                after, limit);
    std::vector<OutboxItem> items;
    while (query.Step()) {
      const auto blob = query.Blob(2);
      items.push_back({query.Int(0), query.Text(1), {blob.begin(), blob.end()}});
    }
    return items;
  });
}

Result<std::int64_t> Outbox::Count() const {
  return Guarded(impl_->path, &impl_->db, [&]() -> Result<std::int64_t> {
    Query query(*impl_, "SELECT count(*) FROM item");
    query.Step();
    return query.Int(0);
  });
}

Status Outbox::Remove(const std::vector<std::int64_t>& sequences) {
  return Guarded(impl_->path, &impl_->db, [&]() -> Status {
    SQLite::Transaction transaction(impl_->db, SQLite::TransactionBehavior::IMMEDIATE);
    for (const std::int64_t sequence : sequences)
      Query(*impl_, "DELETE FROM item WHERE sequence = ?", sequence).Run();
    transaction.commit();
    return {};
  });
}

Result<std::uint8_t> Outbox::NextBirth() {
  return Guarded(impl_->path, &impl_->db, [&]() -> Result<std::uint8_t> {
    SQLite::Transaction transaction(impl_->db, SQLite::TransactionBehavior::IMMEDIATE);
    Query(*impl_, "UPDATE progress SET births = births + 1").Run();
    std::int64_t births = 0;
    {
      Query query(*impl_, "SELECT births FROM progress");
      query.Step();
      births = query.Int(0);
    }
    transaction.commit();
    return static_cast<std::uint8_t>(births - 1);
  });
}

}  // namespace hydroscope
