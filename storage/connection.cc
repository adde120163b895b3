#include "storage/connection.h"

#include <fcntl.h>
#include <sqlite3.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <filesystem>
#include <limits>

#include "core/told_error.h"

namespace hydroscope {
namespace {

/// SQLite says "disk full" itself, or reports an I/O error while the system says so.
bool DiskFull(const SQLite::Database* db, int code) {
  if (code == SQLITE_FULL) return true;
  if (code != SQLITE_IOERR || db == nullptr) return false;
  const int system_error = sqlite3_system_errno(db->getHandle());
  return system_error == ENOSPC || system_error == EDQUOT;
}

std::int64_t Counted(const SQLite::Database& db, int what) {
  int count = 0, highest = 0;
  sqlite3_db_status(db.getHandle(), what, &count, &highest, 0);
  return count;
}

}  // namespace

SQLite::Statement& Connection::Prepared(const char* sql) {
  const auto found = statements_.find(std::string_view(sql));
  if (found != statements_.end()) return found->second;
  return statements_.emplace(sql, SQLite::Statement(db, sql)).first->second;
}

Result<RunRow> Connection::FindRun(std::int64_t run) {
  Query query(*this,
              "SELECT machine, first_sequence, strokes, model_version, state, source FROM run WHERE id = ?",
              run);
  if (!query.Step()) return BadInput(Tell("{} has no run {}", "{} hat keinen Lauf {}", path, run));
  return RunRow{run,           query.Int(0), query.Int(1), query.Int(2), static_cast<int>(query.Int(3)),
                query.Text(4), query.Text(5)};
}

std::vector<RunRow> Connection::RunsOf(std::int64_t machine) {
  Query query(*this,
              "SELECT id, first_sequence, strokes, model_version, state, source "
              "FROM run WHERE machine = ? ORDER BY id",
              machine);
  std::vector<RunRow> runs;
  while (query.Step())
    runs.push_back({query.Int(0), machine, query.Int(1), query.Int(2), static_cast<int>(query.Int(3)),
                    query.Text(4), query.Text(5)});
  return runs;
}

std::vector<std::string> Connection::Columns(std::int64_t machine, int version) {
  Query query(*this, "SELECT name FROM model_column WHERE machine = ? AND version = ? ORDER BY position",
              machine, version);
  std::vector<std::string> names;
  while (query.Step()) names.push_back(query.Text(0));
  return names;
}

int Connection::ColumnCount(std::int64_t machine, int version) {
  // Positions count from 0, and the greatest one is found at once.
  Query query(*this, "SELECT max(position) + 1 FROM model_column WHERE machine = ? AND version = ?", machine,
              version);
  return query.Step() && !query.IsNull(0) ? static_cast<int>(query.Int(0)) : 0;
}

std::int64_t Connection::PagesFound() const { return Counted(db, SQLITE_DBSTATUS_CACHE_HIT); }
std::int64_t Connection::PagesRead() const { return Counted(db, SQLITE_DBSTATUS_CACHE_MISS); }

std::string PathBeside(const std::string& database, const std::string& what) {
  const std::filesystem::path path(database);
  return (path.parent_path() / (path.stem().string() + "." + what + path.extension().string())).string();
}

void CreateForOwnerAndGroup(const std::string& path) {
  // Only a file that is not there: closing one that this process has open elsewhere would drop SQLite's locks on it.
  const int file = open(path.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0640);
  if (file >= 0) close(file);
}

bool OnReadOnlyDisk(const std::string& path) {
  std::error_code ignored;
  const auto folder = std::filesystem::absolute(path, ignored).parent_path();
  return faccessat(AT_FDCWD, folder.c_str(), W_OK, AT_EACCESS) != 0 &&
         !std::filesystem::exists(path + "-wal", ignored);
}

std::string ImmutableUri(const std::string& path) {
  std::string uri = "file:";
  for (const char c : path)
    uri += c == '%' || c == '?' || c == '#' ? fmt::format("%{:02X}", c) : std::string(1, c);
  return uri + "?immutable=1";
}

Query::~Query() {
  statement_.tryReset();  // ends the read transaction the statement may hold
}

double Query::Real(int column) const {
  const SQLite::Column value = statement_.getColumn(column);
  return value.isNull() ? std::numeric_limits<double>::quiet_NaN() : value.getDouble();
}

std::span<const std::uint8_t> Query::Blob(int column) const {
  const SQLite::Column value = statement_.getColumn(column);
  const auto* bytes = static_cast<const std::uint8_t*>(value.getBlob());
  return {bytes, static_cast<std::size_t>(value.getBytes())};
}

void Query::Bind(double value) {
  if (std::isnan(value))
    statement_.bind(++bound_);
  else
    statement_.bind(++bound_, value);
}

void Query::Bind(const std::vector<std::uint8_t>& blob) {
  // A null pointer would bind NULL instead of an empty blob.
  static constexpr std::uint8_t kNothing = 0;
  statement_.bindNoCopy(++bound_, blob.empty() ? &kNothing : blob.data(), static_cast<int>(blob.size()));
}

Error DatabaseError(const std::string& path, const SQLite::Database* db, const SQLite::Exception& exception) {
  const int code = exception.getErrorCode() & 0xff;
  if (DiskFull(db, code))
    return {
        ErrorKind::kInternal,
        fmt::format(
            "{}: the disk is full. What was stored before is safe; free some space on that disk and run the "
            "same command again, it continues where it stopped",
            path)};
  switch (code) {
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      return {ErrorKind::kInternal, fmt::format("{}: another process has been writing for more than {} s; "
                                                "wait until it is done, or use another database",
                                                path, kBusyTimeout / 1000)};
    case SQLITE_NOTADB:
      return {ErrorKind::kBadInput,
              fmt::format("{} is no hydroscope database (not an SQLite file); it was left as it is", path)};
    case SQLITE_CORRUPT:
      return {
          ErrorKind::kBadInput,
          fmt::format("{} is damaged ({}). Restore it from a copy, or replay the logs into a new database",
                      path, exception.what())};
    case SQLITE_READONLY:
    case SQLITE_PERM:
      return {ErrorKind::kBadInput,
              fmt::format("{} cannot be written ({}); check the permissions of the file and its folder", path,
                          exception.what())};
    case SQLITE_CANTOPEN:
      if (access(path.c_str(), F_OK) == 0 && access(path.c_str(), R_OK) != 0)
        return {
            ErrorKind::kBadInput,
            fmt::format(
                "{} may not be read by this user; its owner and its group may: ask for that group, or run "
                "the command as its owner",
                path)};
      return {ErrorKind::kBadInput,
              fmt::format("cannot open {}; check that the folder exists and may be written", path)};
    case SQLITE_IOERR:
      return {ErrorKind::kInternal,
              fmt::format(
                  "{} cannot be written or read ({}); is its disk sound, or is there a limit on the size of "
                  "files (`ulimit -f`)?",
                  path, exception.what())};
    default:
      return {ErrorKind::kInternal, fmt::format("{}: {} (SQLite error {})", path, exception.what(),
                                                exception.getExtendedErrorCode())};
  }
}

}  // namespace hydroscope
