#include "storage/access_store.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>

#include "core/secret_file.h"
#include "core/shell_word.h"
#include "core/told_error.h"
#include "storage/connection.h"

namespace hydroscope {
namespace {

constexpr const char* kAccessTables = R"sql(
CREATE TABLE user(
  name TEXT PRIMARY KEY,
  role TEXT NOT NULL,
  password TEXT NOT NULL,
  since_s REAL NOT NULL
) STRICT;

CREATE TABLE session(
  id TEXT PRIMARY KEY,
  user TEXT NOT NULL REFERENCES user(name) ON DELETE CASCADE,
  token TEXT NOT NULL,
  begun_s REAL NOT NULL,
  seen_s REAL NOT NULL
) STRICT;

CREATE TABLE audit(
  sequence INTEGER PRIMARY KEY,
  wall_s REAL NOT NULL,
  user TEXT NOT NULL,
  role TEXT NOT NULL,
  address TEXT NOT NULL,
  what TEXT NOT NULL,
  detail TEXT NOT NULL,
  outcome TEXT NOT NULL
) STRICT;
CREATE TRIGGER audit_is_not_changed BEFORE UPDATE ON audit BEGIN SELECT RAISE(ABORT, 'the audit table is append-only'); END;
CREATE TRIGGER audit_is_not_deleted BEFORE DELETE ON audit BEGIN SELECT RAISE(ABORT, 'the audit table is append-only'); END;
)sql";

Status CheckAccessKind(SQLite::Database& db, const std::string& path) {
  const int application = db.execAndGet("PRAGMA application_id").getInt();
  const int version = db.execAndGet("PRAGMA user_version").getInt();
  if (application != kAccessApplicationId)
    return BadInput("{} holds no users (application id {:#x}, expected {:#x}); it was left as it is", path,
                    static_cast<unsigned>(application), static_cast<unsigned>(kAccessApplicationId));
  if (version != kAccessFormat)
    return BadInput("{} has format {}, this program knows {}; use the hydroscope that wrote it", path,
                    version, kAccessFormat);
  return {};
}

Status PrepareAccess(SQLite::Database& db, const std::string& path) {
  db.exec("PRAGMA synchronous = FULL");
  db.exec("PRAGMA foreign_keys = ON");
  const auto fresh = [&] {
    return db.execAndGet("SELECT count(*) FROM sqlite_master").getInt() == 0 &&
           db.execAndGet("PRAGMA application_id").getInt() == 0;
  };
  if (!fresh()) return CheckAccessKind(db, path);
  SQLite::Transaction transaction(db, SQLite::TransactionBehavior::IMMEDIATE);
  if (!fresh()) return CheckAccessKind(db, path);  // another process was faster
  db.exec(kAccessTables);
  db.exec(fmt::format("PRAGMA application_id = {}", kAccessApplicationId));
  db.exec(fmt::format("PRAGMA user_version = {}", kAccessFormat));
  transaction.commit();
  return {};
}

/// An empty file for its owner alone, if there is none. Made by root it is for whoever writes the database.
void CreateForOwner(const std::string& path, const std::string& database) {
  const int file = open(path.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
  if (file < 0) return;
  struct stat owner {};
  const std::string folder = std::filesystem::absolute(path).parent_path().string();
  const bool known = stat(database.c_str(), &owner) == 0 || stat(folder.c_str(), &owner) == 0;
  if (known && geteuid() == 0 && fchown(file, owner.st_uid, owner.st_gid) != 0) unlink(path.c_str());
  close(file);
}

}  // namespace

struct AccessStore::Impl : Connection {
  using Connection::Connection;
};

AccessStore::AccessStore(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
AccessStore::AccessStore(AccessStore&&) noexcept = default;
AccessStore& AccessStore::operator=(AccessStore&&) noexcept = default;
AccessStore::~AccessStore() = default;

std::string AccessStore::PathFor(const std::string& database) { return PathBeside(database, "access"); }

Result<AccessStore> AccessStore::Open(const std::string& database) {
  const std::string path = PathFor(database);
  CreateForOwner(path, database);
  TRY(CheckSecret(path, "users"));
  auto impl = TRY(OpenOrMake<Impl>(path, PrepareAccess));
  return AccessStore(std::move(impl));
}

Result<AccessStore> AccessStore::OpenExisting(const std::string& database) {
  const std::string path = PathFor(database);
  std::error_code ignored;
  if (std::filesystem::exists(path, ignored)) return Open(database);
  return BadInput(
      "there are no users yet ({}); make one with `hydroscope users --db {} add NAME --role admin`", path,
      ShellWord(database));
}

Result<std::vector<StoredUser>> AccessStore::Users() const {
  return Guarded(impl_->path, &impl_->db, [&]() -> Result<std::vector<StoredUser>> {
    Query query(*impl_, "SELECT name, role, password, since_s FROM user ORDER BY name");
    std::vector<StoredUser> users;
    while (query.Step()) users.push_back({query.Text(0), query.Text(1), query.Text(2), query.Real(3)});
    return users;
  });
}

Result<std::optional<StoredUser>> AccessStore::User(const std::string& name) const {
  return Guarded(impl_->path, &impl_->db, [&]() -> Result<std::optional<StoredUser>> {
    Query query(*impl_, "SELECT name, role, password, since_s FROM user WHERE name = ?", name);
    if (!query.Step()) return std::nullopt;
    return StoredUser{query.Text(0), query.Text(1), query.Text(2), query.Real(3)};
  });
}

Status AccessStore::PutUser(const StoredUser& user) {
  return InTransaction(*impl_, [&]() -> Status {
    Query(*impl_, "DELETE FROM user WHERE name = ?", user.name).Run();
    Query(*impl_, "INSERT INTO user VALUES(?, ?, ?, ?)", user.name, user.role, user.password, user.since)
        .Run();
    return {};
  });
}

Status AccessStore::RemoveUser(const std::string& name) {
  return InTransaction(*impl_, [&]() -> Status {
    Query(*impl_, "DELETE FROM user WHERE name = ?", name).Run();
    if (impl_->db.getChanges() == 0)
      return BadInput(Tell("there is no user '{}'", "es gibt keinen Benutzer '{}'", name));
    return {};
  });
}

Result<std::optional<StoredSession>> AccessStore::Session(const std::string& id) const {
  return Guarded(impl_->path, &impl_->db, [&]() -> Result<std::optional<StoredSession>> {
    Query query(*impl_, "SELECT id, user, token, begun_s, seen_s FROM session WHERE id = ?", id);
    if (!query.Step()) return std::nullopt;
    return StoredSession{query.Text(0), query.Text(1), query.Text(2), query.Real(3), query.Real(4)};
  });
}

Status AccessStore::AddSession(const StoredSession& session) {
  return InTransaction(*impl_, [&]() -> Status {
    Query(*impl_, "INSERT INTO session VALUES(?, ?, ?, ?, ?)", session.id, session.user, session.token,
          session.begun, session.seen)
        .Run();
    return {};
  });
}

Status AccessStore::SeeSession(const std::string& id, double seen) {
  return InTransaction(*impl_, [&]() -> Status {
    Query(*impl_, "UPDATE session SET seen_s = ? WHERE id = ?", seen, id).Run();
    return {};
  });
}

Status AccessStore::EndSession(const std::string& id) {
  return InTransaction(*impl_, [&]() -> Status {
    Query(*impl_, "DELETE FROM session WHERE id = ?", id).Run();
    return {};
  });
}

Status AccessStore::EndOldSessions(double begun, double seen) {
  return InTransaction(*impl_, [&]() -> Status {
    Query(*impl_, "DELETE FROM session WHERE begun_s < ? OR seen_s < ?", begun, seen).Run();
    return {};
  });
}

Status AccessStore::Append(const AuditRow& row) {
  return InTransaction(*impl_, [&]() -> Status {
    Query(*impl_,
          "INSERT INTO audit(wall_s, user, role, address, what, detail, outcome) VALUES(?, ?, ?, ?, ?, ?, ?)",
          row.wall, row.user, row.role, row.from, row.what, row.detail, row.outcome)
        .Run();
    return {};
  });
}

Result<std::vector<AuditRow>> AccessStore::Audit(std::int64_t most) const {
  return Guarded(impl_->path, &impl_->db, [&]() -> Result<std::vector<AuditRow>> {
    Query query(*impl_,
                "SELECT sequence, wall_s, user, role, address, what, detail, outcome FROM audit ORDER BY "
                "sequence DESC LIMIT ?",
                most);
    std::vector<AuditRow> rows;
    while (query.Step())
      rows.push_back({query.Int(0), query.Real(1), query.Text(2), query.Text(3), query.Text(4), query.Text(5),
                      query.Text(6), query.Text(7)});
    return rows;
  });
}

}  // namespace hydroscope
