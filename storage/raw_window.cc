#include <algorithm>
#include <cmath>
#include <limits>

#include "storage/connection.h"
#include "storage/database.h"
#include "storage/raw_codec.h"
#include "storage/store_steps.h"

namespace hydroscope {
namespace {

constexpr std::size_t kRowsPerChunk = 1000;

std::string Joined(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ",") + name;
  return text;
}

std::vector<std::string> Split(const std::string& text) {
  std::vector<std::string> names;
  std::size_t from = 0;
  while (from <= text.size() && !text.empty()) {
    const std::size_t comma = std::min(text.find(',', from), text.size());
    names.push_back(text.substr(from, comma - from));
    from = comma + 1;
  }
  return names;
}

Status CheckRaw(const std::vector<std::string>& signals, const std::vector<double>& time,
                const std::vector<std::vector<double>>& values) {
  if (signals.size() != values.size())
    return InternalError("raw samples: {} signal names for {} columns", signals.size(), values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (values[i].size() != time.size())
      return InternalError("raw samples: {} has {} rows, time has {}", signals[i], values[i].size(),
                           time.size());
    if (signals[i].empty() || signals[i].find(',') != std::string::npos)
      return BadInput("raw samples: a signal is called \"{}\"; the name must not be empty or contain a comma",
                      signals[i]);
  }
  for (std::size_t row = 0; row < time.size(); ++row)
    if (!std::isfinite(time[row]) || (row > 0 && !(time[row] > time[row - 1])))
      return BadInput("raw samples: time does not increase at row {} ({} s)", row, time[row]);
  return {};
}

/// Time up to which rows of the run were stored, whether still kept or not; -infinity if there were none.
double StoredUntil(Connection& connection, std::int64_t run) {
  Query query(connection, "SELECT raw_until_s FROM run WHERE id = ?", run);
  return query.Step() && !query.IsNull(0) ? query.Real(0) : -std::numeric_limits<double>::infinity();
}

void AddRawBytes(Connection& connection, std::int64_t machine, std::int64_t bytes) {
  Query(connection, "UPDATE machine SET raw_bytes = raw_bytes + ? WHERE id = ?", bytes, machine).Run();
}

std::int64_t RawBytes(Connection& connection, std::int64_t machine) {
  Query query(connection, "SELECT raw_bytes FROM machine WHERE id = ?", machine);
  query.Step();
  return query.Int(0);
}

/// The machine's oldest chunks go until what is left is small and young enough.
void DropOldest(Connection& connection, std::int64_t machine, const RawLimits& limits, double newest) {
  std::int64_t bytes = RawBytes(connection, machine);
  for (;;) {
    std::int64_t id = 0, size = 0;
    {
      Query oldest(
          connection,
          "SELECT c.id, length(c.samples) + coalesce(length(c.flags), 0), c.last_s FROM raw_chunk c JOIN run "
          "r ON r.id = c.run WHERE r.machine = ? ORDER BY c.id LIMIT 1",
          machine);
      if (!oldest.Step()) return;
      id = oldest.Int(0);
      size = oldest.Int(1);
      if (bytes <= limits.max_bytes && !(oldest.Real(2) < newest - limits.max_age)) return;
    }
    Query(connection, "DELETE FROM raw_chunk WHERE id = ?", id).Run();
    AddRawBytes(connection, machine, -size);
    bytes -= size;
  }
}

/// Flags of rows [from, from + rows) as a blob; empty if all are good.
std::vector<std::uint8_t> PackFlags(const std::vector<std::vector<Quality>>& flags, std::size_t from,
                                    std::size_t rows) {
  std::vector<std::span<const Quality>> columns;
  bool any = false;
  for (const auto& column : flags) {
    columns.push_back(std::span(column).subspan(from, rows));
    any = any || std::any_of(columns.back().begin(), columns.back().end(), [](Quality q) { return q != 0; });
  }
  return any ? PackColumns(columns) : std::vector<std::uint8_t>();
}

}  // namespace

Status AppendRaw(Connection& connection, const RunRow& run, const std::vector<std::string>& signals,
                 const std::vector<double>& time, const std::vector<std::vector<double>>& values,
                 const std::vector<std::vector<Quality>>& flags, const RawLimits& limits) {
  if (const Status valid = CheckRaw(signals, time, values); !valid) return valid;
  const auto first_new = static_cast<std::size_t>(
      std::upper_bound(time.begin(), time.end(), StoredUntil(connection, run.id)) - time.begin());
  if (first_new == time.size()) return {};
  const std::string names = Joined(signals);
  for (std::size_t from = first_new; from < time.size(); from += kRowsPerChunk) {
    const std::size_t rows = std::min(kRowsPerChunk, time.size() - from);
    std::vector<std::span<const double>> columns = {std::span(time).subspan(from, rows)};
    for (const auto& column : values) columns.push_back(std::span(column).subspan(from, rows));
    const auto packed = PackColumns(columns);
    const auto packed_flags = PackFlags(flags, from, rows);
    Query(connection,
          "INSERT INTO raw_chunk(id, run, first_s, last_s, rows, signals, samples, flags) "
          "VALUES((SELECT coalesce(max(id), 0) + 1 FROM raw_chunk), ?, ?, ?, ?, ?, ?, nullif(?, x''))",
          run.id, time[from], time[from + rows - 1], static_cast<std::int64_t>(rows), names, packed,
          packed_flags)
        .Run();
    AddRawBytes(connection, run.machine, static_cast<std::int64_t>(packed.size() + packed_flags.size()));
  }
  Query(connection, "UPDATE run SET raw_until_s = ? WHERE id = ?", time.back(), run.id).Run();
  DropOldest(connection, run.machine, limits, time.back());
  return {};
}

Status Database::StoreRaw(std::int64_t run, const std::vector<std::string>& signals,
                          const std::vector<double>& time, const std::vector<std::vector<double>>& values,
                          std::int64_t max_bytes) {
  return Guarded(impl_->path, &impl_->db, [&]() -> Status {
    SQLite::Transaction transaction(impl_->db, SQLite::TransactionBehavior::IMMEDIATE);
    const auto row = impl_->FindRun(run);
    if (!row) return tl::unexpected(row.error());
    constexpr double kAnyAge = std::numeric_limits<double>::infinity();
    if (const Status stored = AppendRaw(*impl_, *row, signals, time, values, {}, {max_bytes, kAnyAge});
        !stored)
      return stored;
    transaction.commit();
    return {};
  });
}

Result<RawWindow> Database::LoadRaw(std::int64_t run, double from, double to) const {
  return Guarded(impl_->path, &impl_->db, [&]() -> Result<RawWindow> {
    if (const auto row = impl_->FindRun(run); !row) return tl::unexpected(row.error());
    Query query(*impl_,
                "SELECT first_s, rows, signals, samples, flags FROM raw_chunk WHERE run = ? AND last_s >= ? "
                "AND first_s < ? "
                "ORDER BY first_s",
                run, from, to);
    RawWindow window;
    while (query.Step()) {
      const std::vector<std::string> signals = Split(query.Text(2));
      if (window.signals.empty()) window.signals = signals;
      window.values.resize(window.signals.size());
      window.flags.resize(window.signals.size());
      const auto chunk =
          UnpackColumns(query.Blob(3), signals.size() + 1, static_cast<std::size_t>(query.Int(1)));
      if (!chunk)
        return BadInput("{}: run {}, raw samples from {} s: {}", impl_->path, run, query.Real(0),
                        chunk.error().text);
      if (signals != window.signals)
        return BadInput("{}: run {} changes its signals at {} s", impl_->path, run, query.Real(0));
      const auto& time = chunk->front();
      const auto begin = std::lower_bound(time.begin(), time.end(), from) - time.begin();
      const auto end = std::lower_bound(time.begin(), time.end(), to) - time.begin();
      window.time.insert(window.time.end(), time.begin() + begin, time.begin() + end);
      for (std::size_t i = 0; i < signals.size(); ++i)
        window.values[i].insert(window.values[i].end(), (*chunk)[i + 1].begin() + begin,
                                (*chunk)[i + 1].begin() + end);
      std::vector<std::vector<Quality>> flags(signals.size(), std::vector<Quality>(time.size()));
      if (!query.IsNull(4)) {
        auto unpacked = UnpackFlags(query.Blob(4), signals.size(), time.size());
        if (!unpacked)
          return BadInput("{}: run {}, flags of raw samples from {} s: {}", impl_->path, run, query.Real(0),
                          unpacked.error().text);
        flags = std::move(*unpacked);
      }
      for (std::size_t i = 0; i < signals.size(); ++i)
        window.flags[i].insert(window.flags[i].end(), flags[i].begin() + begin, flags[i].begin() + end);
    }
    return window;
  });
}

}  // namespace hydroscope
