#include <sqlite3.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <limits>
#include <string_view>

#include "core/told_error.h"
#include "storage/blobs/content_hash.h"
#include "storage/connection.h"
#include "storage/database.h"
#include "storage/gram_rollup.h"

namespace hydroscope {
namespace {

/// Every table in order of its key.
constexpr std::array<const char*, 12> kCheckedTables = {
    "SELECT * FROM machine ORDER BY id",
    "SELECT * FROM model_version ORDER BY machine, version",
    "SELECT * FROM model_column ORDER BY machine, version, position",
    "SELECT * FROM run ORDER BY id",
    "SELECT * FROM stroke ORDER BY run, stroke",
    "SELECT * FROM stroke_flag ORDER BY run, stroke, flag",
    "SELECT * FROM parameter ORDER BY id",
    "SELECT * FROM estimate ORDER BY run, stroke, parameter",
    "SELECT * FROM gram ORDER BY run, stroke",
    "SELECT * FROM gram_rollup ORDER BY machine, strokes, first_sequence",
    "SELECT * FROM raw_chunk ORDER BY id",
    "SELECT * FROM valve_check ORDER BY machine, number",
};

void AddValue(Fnv1a& hash, const SQLite::Column& value) {
  hash.Add(static_cast<std::int64_t>(value.getType()));
  if (value.isInteger()) return hash.Add(value.getInt64());
  if (value.isFloat()) return hash.Add(value.getDouble());
  if (value.isNull()) return;
  const auto* bytes = static_cast<const std::uint8_t*>(value.getBlob());
  hash.Add(std::span(bytes, static_cast<std::size_t>(value.getBytes())));
}

Status CheckPages(Connection& connection) {
  Query query(connection, "PRAGMA integrity_check(1)");
  query.Step();
  if (query.Text(0) == "ok") return {};
  return BadInput(Tell("{} is damaged: {}", "{} ist beschädigt: {}", connection.path, query.Text(0)));
}

/// Strokes are numbered 0 ... n-1 and runs follow one another.
Status CheckCounts(Connection& connection, std::int64_t machine) {
  std::int64_t next = 0;
  for (const RunRow& run : connection.RunsOf(machine)) {
    Query query(
        connection,
        "SELECT count(*), coalesce(min(stroke), 0), coalesce(max(stroke), -1) FROM stroke WHERE run = ?",
        run.id);
    query.Step();
    if (query.Int(0) != run.strokes || query.Int(1) != 0 || query.Int(2) != run.strokes - 1)
      return BadInput(Tell("{}: run {} ({}) counts {} strokes, but {} from {} to {} are stored",
                           "{}: Lauf {} ({}) zählt {} Hübe, gespeichert sind aber {} von {} bis {}",
                           connection.path, run.id, run.source, run.strokes, query.Int(0), query.Int(1),
                           query.Int(2)));
    if (run.first_sequence != next)
      return BadInput(Tell("{}: run {} ({}) begins at machine stroke {}, expected {}",
                           "{}: Lauf {} ({}) beginnt bei Hub {} der Maschine, erwartet {}", connection.path,
                           run.id, run.source, run.first_sequence, next));
    next += run.strokes;
  }
  return {};
}

std::vector<std::int64_t> MachineIds(Connection& connection) {
  Query query(connection, "SELECT id FROM machine ORDER BY id");
  std::vector<std::int64_t> ids;
  while (query.Step()) ids.push_back(query.Int(0));
  return ids;
}

/// Whether what quick_check says is that a page could not be read, SQLITE_IOERR and its kinds. A write-ahead log that was deleted
/// under us says that of a sound file; and where the disk fails the next step says so.
bool IsReadError(const std::string& found) {
  constexpr std::string_view kCode = "unable to get the page. error code=";
  constexpr int kKinds = 0xff;  // the rest of a code says which kind of error it is
  const std::size_t at = found.find(kCode);
  return at != std::string::npos && (std::atoi(found.c_str() + at + kCode.size()) & kKinds) == SQLITE_IOERR;
}

}  // namespace

Status Database::Check(const std::string& path, const std::stop_token& stop) {
  const auto database = TRY(OpenReadOnly(path));
  constexpr int kInstructions = 1000;  // of SQLite's machine between two looks at `stop`
  const auto stopped = [](void* token) {
    return int{static_cast<const std::stop_token*>(token)->stop_requested()};
  };
  SQLite::Database& db = database.impl_->db;
  sqlite3_progress_handler(db.getHandle(), kInstructions, stopped, const_cast<std::stop_token*>(&stop));
  const Status sound = Guarded(path, &db, [&]() -> Status {
    Query query(*database.impl_, "PRAGMA quick_check(1)");
    query.Step();
    std::string found = query.Text(0);
    if (found == "ok") return {};
    std::ranges::replace(found, '\n', ' ');
    if (IsReadError(found))
      return InternalError(
          Tell("{} cannot be read through ({})", "{} ist nicht bis zum Ende zu lesen ({})", path, found));
    return BadInput(Tell("{} is damaged ({})", "{} ist beschädigt ({})", path, found));
  });
  sqlite3_progress_handler(db.getHandle(), 0, nullptr, nullptr);
  return stop.stop_requested() ? Status{} : sound;
}

Result<std::string> Database::ContentDigest() const {
  return Guarded(impl_->path, &impl_->db, [&]() -> Result<std::string> {
    SQLite::Transaction one_snapshot(impl_->db);
    Fnv1a hash;
    for (const char* table : kCheckedTables) {
      SQLite::Statement rows(impl_->db, table);
      hash.Add(std::string_view(table));
      while (rows.executeStep())
        for (int column = 0; column < rows.getColumnCount(); ++column) AddValue(hash, rows.getColumn(column));
    }
    return fmt::format("{:016x}", hash.value());
  });
}

Status Database::CheckIntegrity() const {
  return Guarded(impl_->path, &impl_->db, [&]() -> Status {
    SQLite::Transaction one_snapshot(impl_->db);
    TRY(CheckPages(*impl_));
    for (const std::int64_t machine : MachineIds(*impl_)) {
      TRY(CheckCounts(*impl_, machine));
      TRY(ForEachGram(*impl_, machine, 0, std::numeric_limits<std::int64_t>::max(),
                      [](const RunRow&, std::int64_t, StrokeGram&&) { return Status(); }));
    }
    return {};
  });
}

}  // namespace hydroscope
