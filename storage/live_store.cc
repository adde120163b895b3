#include "storage/connection.h"
#include "storage/database.h"
#include "storage/gram_rollup.h"
#include "storage/schema.h"
#include "storage/store_steps.h"

namespace hydroscope {
namespace {

constexpr int kLongestLog = 64 << 20;                           ///< bytes
constexpr std::size_t kMemory = 2048, kMemoryOfMachine = 1024;  ///< KiB, of SQLite for pages

void UpdateProgress(Connection& connection, std::int64_t run, const PackedBatch& batch) {
  Query(connection,
        "UPDATE run SET rows_taken = ?, pipeline_state = coalesce(nullif(?, x''), pipeline_state), "
        "sender_marks = coalesce(nullif(?, x''), sender_marks) WHERE id = ?",
        batch.rows_taken, batch.pipeline_state, batch.sender_marks, run)
      .Run();
}

Status StoreStep(Connection& connection, const std::string& path, const LiveStep& step,
                 const std::vector<std::string>& signals, const RawLimits& limits) {
  const PackedBatch& batch = *step.batch;
  if (!batch.raw) return tl::unexpected(batch.raw.error());
  auto row = TRY(connection.FindRun(step.run));
  if (row.state != "open")
    return InternalError("{}: run {} is {} and takes nothing more", path, step.run, row.state);
  TRY(AppendStrokes(connection, row, batch.strokes));
  TRY(AppendRaw(connection, row, signals, *batch.raw, limits));
  UpdateProgress(connection, step.run, batch);
  return {};
}

}  // namespace

Status Database::StoreLive(std::span<const LiveStep> steps, const std::vector<std::string>& signals,
                           const RawLimits& limits) {
  return InTransaction(*impl_, [&]() -> Status {
    for (const LiveStep& step : steps) TRY(StoreStep(*impl_, impl_->path, step, signals, limits));
    return {};
  });
}

Status Database::Checkpoint() {
  return Guarded(impl_->path, &impl_->db, [&]() -> Status {
    impl_->db.exec("PRAGMA wal_checkpoint(PASSIVE)");
    // Who begins the log anew waits for its head to be on the disk: somebody who has nothing to store.
    impl_->db.exec(fmt::format("PRAGMA user_version = {}", kFormatVersion));
    return {};
  });
}

Status Database::KeepPagesOf(std::size_t machines) {
  return Guarded(impl_->path, &impl_->db, [&]() -> Status {
    impl_->db.exec(fmt::format("PRAGMA cache_size = -{}", kMemory + kMemoryOfMachine * machines));
    return {};
  });
}

Status Database::FetchPages(std::int64_t run) {
  return Guarded(impl_->path, &impl_->db, [&]() -> Status {
    SQLite::Transaction one_snapshot(impl_->db);
    const auto row = TRY(impl_->FindRun(run));
    TRY(FetchRollups(*impl_, row.machine, row.first_sequence + row.strokes));
    for (const char* newest :
         {"SELECT max(stroke) FROM stroke WHERE run = ?", "SELECT max(stroke) FROM estimate WHERE run = ?",
          "SELECT max(stroke) FROM gram WHERE run = ?", "SELECT max(first_s) FROM raw_chunk WHERE run = ?"})
      Query(*impl_, newest, run).Step();
    return {};
  });
}

std::int64_t Database::PagesRead() const { return impl_->PagesRead(); }

std::int64_t Database::PagesAsked() const { return impl_->PagesFound() + impl_->PagesRead(); }

Status Database::LeaveCheckpointsToPauses() {
  return Guarded(impl_->path, &impl_->db, [&]() -> Status {
    const int page = impl_->db.execAndGet("PRAGMA page_size").getInt();
    impl_->db.exec(fmt::format("PRAGMA wal_autocheckpoint = {}", kLongestLog / page));
    return {};
  });
}

Result<std::optional<LiveProgress>> Database::NewestRun(std::int64_t machine) const {
  using Found = std::optional<LiveProgress>;
  const auto runs = TRY(Runs(machine));
  if (runs.empty()) return Found();
  return Guarded(impl_->path, &impl_->db, [&]() -> Result<Found> {
    LiveProgress progress;
    progress.run = runs.back();
    Query query(*impl_, "SELECT pipeline_state, sender_marks, rows_taken FROM run WHERE id = ?",
                progress.run.id);
    if (!query.Step()) return Found();
    progress.pipeline_state = query.Bytes(0);
    progress.sender_marks = query.Bytes(1);
    progress.rows_taken = query.Int(2);
    return Found(std::move(progress));
  });
}

Result<std::vector<RawExtent>> Database::RawExtents(std::int64_t machine) const {
  return Guarded(impl_->path, &impl_->db, [&]() -> Result<std::vector<RawExtent>> {
    Query query(*impl_,
                "SELECT r.id, sum(c.rows), sum(length(c.samples) + coalesce(length(c.flags), 0)), count(*), "
                "min(c.first_s), max(c.last_s), r.rows_taken FROM run r JOIN raw_chunk c ON c.run = r.id "
                "WHERE r.machine = ? GROUP BY r.id ORDER BY r.id",
                machine);
    std::vector<RawExtent> extents;
    while (query.Step()) {
      RawExtent& e = extents.emplace_back();
      query.Read(0, e.run, e.rows, e.bytes, e.chunks, e.first, e.last, e.rows_taken);
    }
    return extents;
  });
}

Status Database::AddValveCheck(std::int64_t machine, const ValveCheckRecord& record) {
  return Guarded(impl_->path, &impl_->db, [&]() -> Status {
    const ValveCheck& c = record.check;
    Query(*impl_,
          "INSERT INTO valve_check VALUES(?1, (SELECT coalesce(max(number), 0) + 1 FROM valve_check WHERE "
          "machine = ?1), ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11, ?12, ?13, ?14, ?15, ?16, ?17)",
          machine, c.time, record.outcome, record.detail, c.natural_frequency, c.damping, c.gain, c.dead_time,
          c.bandwidth, c.amplitude, c.supply_pressure, c.oil_temperature)
        .Run();
    return {};
  });
}

Result<std::vector<ValveCheckRecord>> Database::ValveChecks(std::int64_t machine) const {
  return Guarded(impl_->path, &impl_->db, [&]() -> Result<std::vector<ValveCheckRecord>> {
    Query q(*impl_,
            "SELECT begin_s, outcome, detail, f0_Hz, f0_std_Hz, damping, damping_std, gain, gain_std, "
            "dead_time_s, dead_time_std_s, bandwidth_Hz, bandwidth_std_Hz, amplitude, supply_pressure_Pa, "
            "oil_temperature_K FROM valve_check WHERE machine = ? ORDER BY number",
            machine);
    std::vector<ValveCheckRecord> checks;
    while (q.Step()) {
      ValveCheckRecord& record = checks.emplace_back();
      ValveCheck& c = record.check;
      q.Read(0, c.time, record.outcome, record.detail, c.natural_frequency, c.damping, c.gain, c.dead_time,
             c.bandwidth, c.amplitude, c.supply_pressure, c.oil_temperature);
    }
    return checks;
  });
}

}  // namespace hydroscope
