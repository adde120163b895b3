
#include "storage/connection.h"
#include "storage/database.h"

namespace hydroscope {
namespace {

constexpr const char* kRunColumns =
    "SELECT id, source, fingerprint, strokes, first_sequence, state, summary, model_version FROM run";

RunInfo ReadRun(const Query& query) {
  RunInfo run;
  std::string state;
  query.Read(0, run.id, run.source, run.fingerprint, run.strokes, run.first_sequence, state, run.summary_json,
             run.model_version);
  run.complete = state == "complete";
  run.abandoned = state == "abandoned";
  return run;
}

std::optional<RunInfo> FindByFingerprint(Connection& connection, std::int64_t machine,
                                         const std::string& fingerprint) {
  static const std::string sql = std::string(kRunColumns) + " WHERE machine = ? AND fingerprint = ?";
  Query query(connection, sql.c_str(), machine, fingerprint);
  if (!query.Step()) return std::nullopt;
  return ReadRun(query);
}

void RemoveEmptyRun(Connection& connection, const RunRow& run) {
  Query(connection,
        "UPDATE machine SET raw_bytes = raw_bytes - (SELECT coalesce(sum(length(samples) + "
        "coalesce(length(flags), 0)), 0) FROM raw_chunk "
        "WHERE run = ?) WHERE id = ?",
        run.id, run.machine)
      .Run();
  Query(connection, "DELETE FROM raw_chunk WHERE run = ?", run.id).Run();
  Query(connection, "DELETE FROM run WHERE id = ?", run.id).Run();
}

/// Closes what an earlier run of the machine left open.
void CloseOpenRuns(Connection& connection, std::int64_t machine) {
  for (const RunRow& run : connection.RunsOf(machine)) {
    if (run.state != "open") continue;
    if (run.strokes == 0)
      RemoveEmptyRun(connection, run);
    else
      Query(connection, "UPDATE run SET state = 'abandoned' WHERE id = ?", run.id).Run();
  }
}

}  // namespace

Result<RunInfo> Database::BeginRun(std::int64_t machine, int model_version, const std::string& source,
                                   const std::string& fingerprint) {
  TRY(GetModelVersion(machine, model_version));
  return Guarded(impl_->path, &impl_->db, [&]() -> Result<RunInfo> {
    SQLite::Transaction transaction(impl_->db, SQLite::TransactionBehavior::IMMEDIATE);
    const auto known = FindByFingerprint(*impl_, machine, fingerprint);
    if (known && known->abandoned)
      return BadInput(
          "{}: the replay of {} stopped after {} strokes and another log of the machine was replayed since; "
          "its remaining strokes would come out of order. Replay the logs in order into a new database",
          impl_->path, known->source, known->strokes);
    if (known) return *known;
    CloseOpenRuns(*impl_, machine);
    Query(*impl_,
          "INSERT INTO run(id, machine, model_version, source, fingerprint, first_sequence) "
          "VALUES((SELECT coalesce(max(id), 0) + 1 FROM run), ?, ?, ?, ?, ?)",
          machine, model_version, source, fingerprint, NextSequence(impl_->RunsOf(machine)))
        .Run();
    const auto created = FindByFingerprint(*impl_, machine, fingerprint);
    transaction.commit();
    return *created;
  });
}

Status Database::FinishRun(std::int64_t run, const std::string& summary_json,
                           const std::vector<std::uint8_t>& pipeline_state) {
  return Guarded(impl_->path, &impl_->db, [&]() -> Status {
    SQLite::Transaction transaction(impl_->db, SQLite::TransactionBehavior::IMMEDIATE);
    const auto row = TRY(impl_->FindRun(run));
    if (row.state == "complete") {
      Query stored(*impl_, "SELECT 1 FROM run WHERE id = ? AND summary = ? AND pipeline_state = ?", run,
                   summary_json, pipeline_state);
      if (stored.Step()) return {};
      return BadInput("{}: run {} ({}) is already complete with another summary or state", impl_->path, run,
                      row.source);
    }
    if (row.state == "abandoned")
      return BadInput("{}: run {} ({}) was abandoned when a later log was replayed", impl_->path, run,
                      row.source);
    Query(*impl_, "UPDATE run SET state = 'complete', summary = ?, pipeline_state = ? WHERE id = ?",
          summary_json, pipeline_state, run)
        .Run();
    transaction.commit();
    return {};
  });
}

Result<std::optional<std::vector<std::uint8_t>>> Database::PipelineStateBefore(std::int64_t run) const {
  using State = std::optional<std::vector<std::uint8_t>>;
  return Guarded(impl_->path, &impl_->db, [&]() -> Result<State> {
    const auto row = TRY(impl_->FindRun(run));
    Query query(*impl_,
                "SELECT pipeline_state FROM run WHERE machine = ? AND id < ? AND state = "
                "'complete' ORDER BY id DESC LIMIT 1",
                row.machine, run);
    if (!query.Step()) return State();
    return State(query.Bytes(0));
  });
}

Result<std::vector<RunInfo>> Database::Runs(std::int64_t machine) const {
  return Guarded(impl_->path, &impl_->db, [&]() -> Result<std::vector<RunInfo>> {
    static const std::string sql = std::string(kRunColumns) + " WHERE machine = ? ORDER BY id";
    Query query(*impl_, sql.c_str(), machine);
    std::vector<RunInfo> runs;
    while (query.Step()) runs.push_back(ReadRun(query));
    return runs;
  });
}

}  // namespace hydroscope
