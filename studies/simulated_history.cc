#include "studies/simulated_history.h"

#include "pipeline/run_summary.h"

namespace hydroscope {
namespace {

constexpr std::size_t kBatch = 500;  // strokes of one transaction

}  // namespace

Status StoreOverAndOver(Database& database, const std::string& name, const std::string& model_text,
                        const LogStrokes& log, std::int64_t strokes, std::int64_t grams,
                        const std::function<void(std::int64_t)>& progress) {
  const auto id = TRY(database.MachineId(name));
  const auto version = TRY(database.PutModelVersion(
      id, {1, model_text, log.model->ColumnNames(), 0, log.model->ConditionNames()}));
  const auto run = TRY(database.BeginRun(id, version, "simulated", "over and over"));
  std::vector<StrokeRecord> batch;
  for (std::int64_t k = 0; k < strokes; ++k) {
    const StrokeRecord& stroke = log.strokes[static_cast<std::size_t>(k) % log.strokes.size()];
    batch.push_back({stroke.summary, strokes - k <= grams ? stroke.gram : StrokeGram(), stroke.estimates});
    batch.back().summary.index = k;
    if (batch.size() < kBatch && k + 1 < strokes) continue;
    TRY(database.StoreStrokes(run.id, batch));
    batch.clear();
    if (progress) progress(k + 1);
  }
  RunSummary summary;
  summary.sample_period = log.window.period;
  return database.FinishRun(run.id, FormatRunSummary(summary), {});
}

}  // namespace hydroscope
