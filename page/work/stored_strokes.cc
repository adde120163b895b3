#include "page/work/stored_strokes.h"

#include <algorithm>
#include <filesystem>

#include "core/contains.h"
#include "core/told_error.h"
#include "models/machine.h"
#include "pipeline/axis_log.h"
#include "pipeline/log_fingerprint.h"
#include "storage/database.h"

namespace hydroscope {
namespace {

constexpr double kRowsAround = 0.5;  ///< s before and behind a stroke, in which its gate opens and closes

Result<std::int64_t> MachineNamed(Database& database, const std::string& machine) {
  const auto names = TRY(database.MachineNames());
  if (!Contains(names, machine))
    return BadInput(
        Tell("the database has no machine '{}'", "die Datenbank hat keine Maschine „{}“", machine));
  return database.MachineId(machine);
}

/// The newest strokes of the run between these whose raw rows are kept; without strokes: last < first.
Result<KeptStrokes::Piece> KeptOfRun(const Database& database, std::int64_t id, const StrokeStretch& stretch,
                                     const RunInfo& run, const RawExtent& extent) {
  const std::int64_t begin = std::max(stretch.first, run.first_sequence),
                     end = std::min(stretch.last + 1, run.first_sequence + run.strokes);
  KeptStrokes::Piece piece{begin, begin - 1, ""};
  if (begin >= end) return piece;
  const auto summaries = TRY(database.SummariesOf(id, begin, end, end - begin));
  double from = 0, to = 0;
  for (const StrokeSummary& stroke : summaries) {
    if (stroke.begin < extent.first || stroke.end > extent.last) continue;
    if (piece.last < piece.first) {
      piece.first = stroke.index;
      from = stroke.begin;
    }
    piece.last = stroke.index;
    to = stroke.end;
  }
  piece.log = fmt::format("/{}@={:.6f}:{:.6f}", run.id, from - kRowsAround, to + kRowsAround);
  return piece;
}

/// The log that a run was replayed from, where it was then or beside the database; "" if it is not there any more, or is another.
std::string LogOfRun(const std::string& database, const RunInfo& run) {
  RunFingerprint fingerprint;
  if (!RunFingerprint::Parse(run.fingerprint, fingerprint)) return "";  // a run of a service
  const std::filesystem::path folder = std::filesystem::path(database).parent_path();
  const std::string beside = (folder / std::filesystem::path(PathOfLog(run.source)).filename()).string() +
                             run.source.substr(PathOfLog(run.source).size());
  for (const std::string& log : {run.source, beside}) {
    const auto found = FingerprintLog(PathOfLog(log));
    if (found && *found == fingerprint.log) return log;
  }
  return "";
}

/// All strokes of a run some of which are asked for, with the log they come from; nullopt where that is gone.
std::optional<KeptStrokes::Piece> ReplayedRun(const std::string& database, const StrokeStretch& stretch,
                                              const RunInfo& run) {
  const std::int64_t last = run.first_sequence + run.strokes - 1;
  if (last < stretch.first || run.first_sequence > stretch.last) return std::nullopt;
  std::string log = LogOfRun(database, run);
  if (log.empty()) return std::nullopt;
  return KeptStrokes::Piece{run.first_sequence, last, std::move(log)};
}

}  // namespace

Result<KeptStrokes> FindKeptStrokes(const std::string& path, const StrokeStretch& asked) {
  auto database = TRY(Database::OpenReadOnly(path));
  const auto id = TRY(MachineNamed(database, asked.machine));
  const auto end = TRY(database.EndSequence(id));
  StrokeStretch stretch = asked;
  stretch.last = std::min(stretch.last, end - 1);
  stretch.first = std::max(stretch.first, stretch.last - KeptStrokes::kMost + 1);
  const auto runs = database.Runs(id);
  const auto extents = database.RawExtents(id);
  if (!runs) return tl::unexpected(runs.error());
  if (!extents) return tl::unexpected(extents.error());
  KeptStrokes kept;
  for (const RunInfo& run : *runs) {
    const auto extent =
        std::find_if(extents->begin(), extents->end(), [&](const RawExtent& e) { return e.run == run.id; });
    if (extent == extents->end()) {
      if (auto piece = ReplayedRun(path, stretch, run)) kept.pieces.push_back(std::move(*piece));
      continue;
    }
    auto piece = TRY(KeptOfRun(database, id, stretch, run, *extent));
    if (piece.last < piece.first) continue;
    piece.log = path + "#" + asked.machine + piece.log;
    kept.pieces.push_back(std::move(piece));
  }
  if (kept.pieces.empty())
    return BadInput(Tell(
        "the raw signals of strokes {} to {} are not kept: a service keeps those of the last days (--raw-days, "
        "--raw-gb); a replayed log is read again where it still lies unchanged, in its place or beside the database",
        "die Rohsignale der Hübe {} bis {} sind nicht aufbewahrt: ein Dienst behält die der letzten Tage "
        "(--raw-days, --raw-gb); ein eingespieltes Log wird wieder gelesen, wo es unverändert noch liegt, an seinem Ort "
        "oder neben der Datenbank",
        asked.first, asked.last));
  const auto promoted = TRY(database.PromotedModel(id));
  const auto model = TRY(promoted ? Result<ModelVersion>(*promoted)
                                  : database.GetModelVersion(id, runs->back().model_version));
  kept.definition = model.definition;
  return kept;
}

Status PromoteWorkedOn(const std::string& path, Promotion promotion) {
  auto database = TRY(Database::Open(path));
  promotion.id = TRY(MachineNamed(database, promotion.machine));
  const auto promoted = Promote(database, path, promotion);
  return promoted ? Status() : tl::unexpected(promoted.error());
}

}  // namespace hydroscope
