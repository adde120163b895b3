#pragma once

#include <SQLiteCpp/SQLiteCpp.h>

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "storage/database.h"

namespace hydroscope {

/// ms to wait for another process that writes.
inline constexpr int kBusyTimeout = 10'000;

/// A row of table `run`.
struct RunRow {
  std::int64_t id = 0, machine = 0, first_sequence = 0, strokes = 0;
  int model_version = 0;
  std::string state, source;
};

/// The number that the next stroke of a machine gets, which has these runs.
inline std::int64_t NextSequence(const std::vector<RunRow>& runs) {
  return runs.empty() ? 0 : runs.back().first_sequence + runs.back().strokes;
}

/// Sums are kept of every full group of so many strokes, by machine-wide sequence and starting at multiples of it.
inline constexpr std::array<std::int64_t, 2> kRollupStrokes = {64, 4096};

/// Sum of several strokes with their model version.
struct Rollup {
  StrokeGram gram;
  int model_version = 0;
};

/// Sum of a group so far, of its strokes or of its smaller groups.
struct GroupUnderWay {
  std::int64_t next = -1;  ///< sequence that has to come; -1: its begin was not seen
  bool uniform = true;     ///< all are there, and of one model version
  Rollup sum = {};
};

/// What a connection remembers of a machine to spare look-ups; forgotten when a transaction fails.
struct MachineMemory {
  /// The run in which the oldest raw rows were found last; earlier runs keep none.
  std::int64_t oldest_kept_run = 0;
  /// Steps of the clock between the runs `steps_from` to `steps_to`, s.
  std::int64_t steps_from = -1, steps_to = -1;
  double steps = 0;
  std::array<GroupUnderWay, kRollupStrokes.size()> groups;  ///< of each size of kRollupStrokes
};

/// An open database file with its prepared statements and the look-ups that several parts need. Throws
/// SQLite::Exception; only storage/*.cc include this.
class Connection {
 public:
  /// `name` is what SQLite opens, `file` what messages call it.
  Connection(const std::string& file, const std::string& name, int flags)
      : path(file), db(name, flags, kBusyTimeout) {}

  SQLite::Statement& Prepared(const char* sql);
  /// An error naming the run if it does not exist.
  Result<RunRow> FindRun(std::int64_t run);
  /// All runs of a machine in order of sequence.
  std::vector<RunRow> RunsOf(std::int64_t machine);
  /// Names of the Gram columns of a model version, in order.
  std::vector<std::string> Columns(std::int64_t machine, int version);
  int ColumnCount(std::int64_t machine, int version);
  /// Pages that SQLite looked at since the file was opened: those in its own memory, and those read into it.
  std::int64_t PagesFound() const;
  std::int64_t PagesRead() const;

  std::string path;
  SQLite::Database db;
  std::map<std::int64_t, MachineMemory> memory;  ///< by machine

 private:
  /// Prepared once per text; a statement belongs to one Query at a time.
  std::map<std::string, SQLite::Statement, std::less<>> statements_;
};

struct Database::Impl : Connection {
  using Connection::Connection;
};

/// One use of a prepared statement: binds in order, steps, and resets at the end of its scope. NaN is stored
/// as NULL and read back as NaN; a ValueWithStd is two columns. Blobs are not copied: they must live until the last Step.
class Query {
 public:
  template <typename... Values>
  Query(Connection& connection, const char* sql, const Values&... values)
      : statement_(connection.Prepared(sql)) {
    (Bind(values), ...);
  }
  ~Query();
  Query(const Query&) = delete;
  Query& operator=(const Query&) = delete;

  /// Moves to the next row; false at the end.
  bool Step() { return statement_.executeStep(); }
  /// Runs a statement without rows.
  void Run() { statement_.exec(); }

  std::int64_t Int(int column) const { return statement_.getColumn(column).getInt64(); }
  double Real(int column) const;
  std::string Text(int column) const { return statement_.getColumn(column).getString(); }
  bool IsNull(int column) const { return statement_.getColumn(column).isNull(); }
  /// Valid until the next Step.
  std::span<const std::uint8_t> Blob(int column) const;
  std::vector<std::uint8_t> Bytes(int column) const {
    const auto blob = Blob(column);
    return {blob.begin(), blob.end()};
  }
  /// The columns from `column` on, in order.
  template <typename... Values>
  void Read(int column, Values&... values) const {
    (Get(column, values), ...);
  }

 private:
  void Bind(std::int64_t value) { statement_.bind(++bound_, value); }
  void Bind(int value) { statement_.bind(++bound_, value); }
  void Bind(double value);
  void Bind(const std::string& value) { statement_.bind(++bound_, value); }
  void Bind(const char* value) { statement_.bind(++bound_, value); }
  void Bind(const std::vector<std::uint8_t>& blob);
  void Bind(const ValueWithStd& value) {
    Bind(value.value);
    Bind(value.std);
  }
  /// Each moves `column` behind what it took.
  template <typename Integer>
  void Get(int& column, Integer& value) const {
    value = static_cast<Integer>(Int(column++));
  }
  void Get(int& column, double& value) const { value = Real(column++); }
  void Get(int& column, std::string& value) const { value = Text(column++); }
  void Get(int& column, ValueWithStd& value) const {
    Get(column, value.value);
    Get(column, value.std);
  }

  SQLite::Statement& statement_;
  int bound_ = 0;
};

/// An exception of SQLite as a value: full disk, lock, damage, read-only file each with what to do.
Error DatabaseError(const std::string& path, const SQLite::Database* db, const SQLite::Exception& exception);

/// Runs `body` and turns exceptions into errors; a transaction opened inside has then been rolled back.
template <typename Body>
auto Guarded(const std::string& path, const SQLite::Database* db, Body&& body) -> decltype(body()) {
  try {
    return body();
  } catch (const SQLite::Exception& exception) {
    return tl::unexpected(DatabaseError(path, db, exception));
  } catch (const std::exception& exception) {
    return InternalError("{}: {}", path, exception.what());
  }
}

/// Makes a file that only its owner and its group may read, if there is none: what lies beside it while it is
/// open gets the same mode. What keeps it from being made SQLite tells when it opens it.
void CreateForOwnerAndGroup(const std::string& path);

/// "press.alarms.db" for "press.db" and "alarms".
std::string PathBeside(const std::string& database, const std::string& what);

/// Opens a file for writing and makes it if there is none; `prepare` sees to its tables and says whether it is of the kind.
template <typename Kind, typename Prepare>
Result<std::unique_ptr<Kind>> OpenOrMake(const std::string& path, const Prepare& prepare) {
  return Guarded(path, nullptr, [&]() -> Result<std::unique_ptr<Kind>> {
    CreateForOwnerAndGroup(path);
    auto kind = std::make_unique<Kind>(path, path, SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE);
    TRY(prepare(kind->db, path));
    return kind;
  });
}

/// Nobody can write there, and the file is complete without its write-ahead log.
bool OnReadOnlyDisk(const std::string& path);
/// Name under which SQLite reads such a file without locks.
std::string ImmutableUri(const std::string& path);

/// Opens an existing file for reading, also one that we may not write. `check` says whether it is of the kind.
template <typename Kind, typename Check>
Result<std::unique_ptr<Kind>> OpenForReading(const std::string& path, const Check& check) {
  const auto open = [&](const std::string& name, int flags) -> Result<std::unique_ptr<Kind>> {
    return Guarded(path, nullptr, [&]() -> Result<std::unique_ptr<Kind>> {
      auto kind = std::make_unique<Kind>(path, name, flags);
      kind->db.exec("PRAGMA query_only = ON");
      TRY(check(kind->db, path));
      return kind;
    });
  };
  // Not SQLITE_OPEN_READONLY: such a reader leaves -wal and -shm files behind.
  auto opened = open(path, SQLite::OPEN_READWRITE);
  if (!opened && OnReadOnlyDisk(path))
    opened = open(ImmutableUri(path), SQLite::OPEN_READONLY | SQLite::OPEN_URI);
  return opened;
}

/// Runs `body` in a transaction, which is committed if it succeeds; else nothing of it stays.
template <typename Body>
Status InTransaction(Connection& connection, Body&& body) {
  const Status done = Guarded(connection.path, &connection.db, [&]() -> Status {
    SQLite::Transaction transaction(connection.db, SQLite::TransactionBehavior::IMMEDIATE);
    TRY(body());
    transaction.commit();
    return {};
  });
  if (!done) connection.memory.clear();
  return done;
}

}  // namespace hydroscope
