#include "live/verify_live.h"

#include <cmath>

#include "live/writer.h"
#include "pipeline/log_pass.h"
#include "pipeline/pipeline.h"
#include "pipeline/raw_log.h"

namespace hydroscope {
namespace {

/// Strokes of the run as a replay of its raw rows gives them.
Result<std::vector<StrokeRecord>> ReplayRun(const std::string& path, const Database& database,
                                            std::int64_t machine_id, const RunInfo& run,
                                            const RawExtent& extent) {
  const auto model = TRY(database.GetModelVersion(machine_id, run.model_version));
  const auto machine =
      TRY(ParseMachine(model.definition, fmt::format("{}: model version {}", path, run.model_version)));
  auto reader = TRY(OpenRawRun(path, run.id, extent.first, extent.last, machine));
  std::vector<StrokeRecord> strokes;
  auto pipeline = TRY(Pipeline::Create(machine, reader->SamplePeriod(),
                                       [&](StrokeRecord&& record) { strokes.push_back(std::move(record)); }));
  const auto state = TRY(database.PipelineStateBefore(run.id));
  if (state) static_cast<void>(pipeline->RestoreState(*state));  // as the service: anew if it does not fit
  LogPassHooks as_live;
  as_live.distrust_logger = false;
  const auto pass = TRY(PassLog(*reader, machine, pipeline.get(), fmt::format("run {}", run.id), as_live));
  if (!pass.summary.stopped.empty()) return BadInput("{}", pass.summary.stopped);
  return strokes;
}

}  // namespace

Result<std::vector<VerifiedRun>> VerifyLive(const std::string& path) {
  auto database = TRY(Database::OpenReadOnly(path));
  const auto names = TRY(database.MachineNames());
  std::vector<VerifiedRun> verified;
  for (const std::string& name : names) {
    const auto machine = TRY(database.MachineId(name));
    const auto runs = database.Runs(machine);
    const auto extents = database.RawExtents(machine);
    if (!runs) return tl::unexpected(runs.error());
    if (!extents) return tl::unexpected(extents.error());
    for (const RunInfo& run : *runs) {
      if (!run.fingerprint.starts_with("live/")) continue;
      VerifiedRun result{.axis = name, .run = run.id, .strokes = run.strokes, .detail = {}};
      const auto extent =
          std::find_if(extents->begin(), extents->end(), [&](const auto& e) { return e.run == run.id; });
      if (extent == extents->end() && run.strokes == 0) continue;
      const bool continued = run.fingerprint.ends_with(kBegunAnew);
      if (!run.complete || continued || extent == extents->end() || extent->rows < extent->rows_taken) {
        result.outcome = VerifiedRun::Outcome::kNotKept;
        result.detail = continued       ? "begun in a database that was lost"
                        : !run.complete ? "still open"
                                        : "not all raw rows are kept";
        verified.push_back(std::move(result));
        continue;
      }
      result.rows = extent->rows;
      const auto strokes = TRY(ReplayRun(path, database, machine, run, *extent));
      if (const Status same = database.CompareStrokes(run.id, strokes); !same) {
        result.outcome = VerifiedRun::Outcome::kDiffers;
        result.detail = same.error().text;
      }
      verified.push_back(std::move(result));
    }
  }
  return verified;
}

}  // namespace hydroscope
