#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/constants.h"
#include "storage/blobs/raw_codec.h"
#include "storage/connection.h"
#include "storage/database.h"
#include "storage/store_steps.h"

namespace hydroscope {
namespace {

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

Status CheckNames(const std::vector<std::string>& signals, std::size_t columns) {
  if (signals.size() != columns)
    return InternalError("raw samples: {} signal names for {} columns", signals.size(), columns);
  for (const std::string& name : signals)
    if (name.empty() || name.find(',') != std::string::npos)
      return BadInput("raw samples: a signal is called \"{}\"; the name must not be empty or contain a comma",
                      name);
  return {};
}

void AddRawBytes(Connection& connection, std::int64_t machine, std::int64_t bytes) {
  Query(connection, "UPDATE machine SET raw_bytes = raw_bytes + ? WHERE id = ?", bytes, machine).Run();
}

std::int64_t RawBytes(Connection& connection, std::int64_t machine) {
  Query query(connection, "SELECT raw_bytes FROM machine WHERE id = ?", machine);
  query.Step();
  return query.Int(0);
}

struct OldestChunk {
  std::int64_t id = 0, bytes = 0;
  double last = 0;  ///< s
};

std::optional<OldestChunk> OldestChunkOf(Connection& connection, std::int64_t run) {
  Query query(connection,
              "SELECT id, length(samples) + coalesce(length(flags), 0), last_s FROM "
              "raw_chunk WHERE run = ? ORDER BY first_s LIMIT 1",
              run);
  if (!query.Step()) return std::nullopt;
  return OldestChunk{query.Int(0), query.Int(1), query.Real(2)};
}

/// The first run of the machine, from `from` on, of which raw rows are kept; `from` if there is none. The
/// plus sign has the runs looked at in order of their ids, so that it ends at the first one.
std::int64_t OldestKeptRun(Connection& connection, std::int64_t machine, std::int64_t from) {
  Query query(connection,
              "SELECT id FROM run WHERE id >= ? AND +machine = ? AND EXISTS (SELECT 1 FROM raw_chunk WHERE "
              "run = run.id) ORDER BY id LIMIT 1",
              from, machine);
  return query.Step() ? query.Int(0) : from;
}

/// s by which times jumped from one run to the next, from run `first` to run `last`: by more than `least`, to and
/// fro. A clock that is wrong by years between two runs shall not make what is kept look old; a machine that
/// stood still for as long does not either.
double StepsOfTheClock(Connection& connection, std::int64_t machine, std::int64_t first, std::int64_t last,
                       double least) {
  MachineMemory& memory = connection.memory[machine];
  if (memory.steps_from == first && memory.steps_to == last) return memory.steps;
  Query query(connection,
              "SELECT (SELECT min(first_s) FROM raw_chunk WHERE run = run.id), raw_until_s FROM run "
              "WHERE id BETWEEN ? AND ? AND +machine = ? ORDER BY id",
              first, last, machine);
  double steps = 0;
  std::optional<double> until;
  while (query.Step()) {
    if (query.IsNull(0)) continue;
    if (const double step = query.Real(0) - until.value_or(query.Real(0)); std::abs(step) > least)
      steps += step;
    until = query.Real(1);
  }
  memory.steps_from = first;
  memory.steps_to = last;
  return memory.steps = steps;
}

/// The machine's oldest chunks go until what is left is small and young enough. However much is kept, the
/// oldest is found at once: it lies in the run that held it last time or in a later one.
void DropOldest(Connection& connection, const RunRow& run, const RawLimits& limits, double newest) {
  std::int64_t& oldest_run = connection.memory[run.machine].oldest_kept_run;
  oldest_run = std::min(oldest_run, run.id);
  std::int64_t bytes = RawBytes(connection, run.machine);
  for (;;) {
    auto oldest = OldestChunkOf(connection, oldest_run);
    if (!oldest) {
      oldest_run = OldestKeptRun(connection, run.machine, oldest_run);
      oldest = OldestChunkOf(connection, oldest_run);
    }
    if (!oldest) return;
    const double steps = StepsOfTheClock(connection, run.machine, oldest_run, run.id, limits.max_age);
    if (bytes <= limits.max_bytes && !(oldest->last < newest - steps - limits.max_age)) return;
    Query(connection, "DELETE FROM raw_chunk WHERE id = ?", oldest->id).Run();
    AddRawBytes(connection, run.machine, -oldest->bytes);
    bytes -= oldest->bytes;
  }
}

}  // namespace

double RawStoredUntil(Connection& connection, std::int64_t run) {
  Query query(connection, "SELECT raw_until_s FROM run WHERE id = ?", run);
  return query.Step() && !query.IsNull(0) ? query.Real(0) : -std::numeric_limits<double>::infinity();
}

Status AppendRaw(Connection& connection, const RunRow& run, const std::vector<std::string>& signals,
                 std::span<const RawChunk> chunks, const RawLimits& limits) {
  if (chunks.empty()) return {};
  if (const double until = RawStoredUntil(connection, run.id); !(chunks.front().first > until))
    return InternalError("raw samples from {} s on: the run has rows up to {} s", chunks.front().first,
                         until);
  const std::string names = Joined(signals);
  std::int64_t bytes = 0;
  for (const RawChunk& chunk : chunks) {
    TRY(CheckNames(signals, chunk.signals));
    Query(connection,
          "INSERT INTO raw_chunk(id, run, first_s, last_s, rows, signals, samples, flags) "
          "VALUES((SELECT coalesce(max(id), 0) + 1 FROM raw_chunk), ?, ?, ?, ?, ?, ?, nullif(?, x''))",
          run.id, chunk.first, chunk.last, chunk.rows, names, chunk.samples, chunk.flags)
        .Run();
    bytes += chunk.bytes();
  }
  AddRawBytes(connection, run.machine, bytes);
  Query(connection, "UPDATE run SET raw_until_s = ? WHERE id = ?", chunks.back().last, run.id).Run();
  DropOldest(connection, run, limits, chunks.back().last);
  return {};
}

Status Database::StoreRaw(std::int64_t run, const std::vector<std::string>& signals,
                          const std::vector<double>& time, const std::vector<std::vector<double>>& values,
                          std::int64_t max_bytes) {
  return InTransaction(*impl_, [&]() -> Status {
    const auto row = TRY(impl_->FindRun(run));
    TRY(CheckNames(signals, values.size()));
    for (std::size_t i = 0; i < values.size(); ++i)
      if (values[i].size() != time.size())
        return InternalError("raw samples: {} has {} rows, time has {}", signals[i], values[i].size(),
                             time.size());
    ColumnPacker packer;
    const auto chunks = TRY(PackRaw(time, values, {}, RawStoredUntil(*impl_, run), packer));
    constexpr double kAnyAge = std::numeric_limits<double>::infinity();
    return AppendRaw(*impl_, row, signals, chunks, {max_bytes, kAnyAge});
  });
}

namespace {

/// Where the first chunk begins that has rows at `from` or later, infinite if there is none. Chunks of a run do not overlap.
double ChunkFrom(Connection& connection, std::int64_t run, double from) {
  Query query(connection,
              "SELECT first_s FROM raw_chunk WHERE run = ?1 AND last_s >= ?2 AND first_s >= coalesce((SELECT "
              "max(first_s) FROM raw_chunk WHERE run = ?1 AND first_s <= ?2), ?2) ORDER BY first_s LIMIT 1",
              run, from);
  return query.Step() ? query.Real(0) : kInfinity;
}

}  // namespace

Result<RawWindow> Database::LoadRaw(std::int64_t run, double from, double to) const {
  return Guarded(impl_->path, &impl_->db, [&]() -> Result<RawWindow> {
    TRY(impl_->FindRun(run));
    Query query(
        *impl_,
        "SELECT first_s, rows, signals, samples, flags FROM raw_chunk WHERE run = ? AND first_s >= ? AND "
        "first_s < ? ORDER BY first_s",
        run, ChunkFrom(*impl_, run, from), to);
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
      const auto begin = std::ranges::lower_bound(time, from) - time.begin();
      const auto end = std::ranges::lower_bound(time, to) - time.begin();
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

Result<double> Database::NextRaw(std::int64_t run, double from) const {
  return Guarded(impl_->path, &impl_->db,
                 [&]() -> Result<double> { return std::max(from, ChunkFrom(*impl_, run, from)); });
}

}  // namespace hydroscope
