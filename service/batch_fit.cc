#include "service/batch_fit.h"

#include "acquisition/quality_monitor.h"
#include "service/output.h"

namespace hydroscope {
namespace {

constexpr std::size_t kRowsPerBlock = 1024;

}  // namespace

std::vector<StrokeGram> LogStrokes::Grams() const {
  std::vector<StrokeGram> grams;
  for (const StrokeRecord& stroke : strokes) grams.push_back(stroke.gram);
  return grams;
}

Result<LogStrokes> ReadStrokes(const std::string& log, const Machine& machine, const Pipeline::EquationTap& tap) {
  auto reader = OpenLog(log, machine);
  if (!reader) return tl::unexpected(reader.error());
  LogStrokes out;
  out.machine = machine;
  auto pipeline = Pipeline::Create(machine, (*reader)->SamplePeriod(),
                                   [&](StrokeRecord&& record) { out.strokes.push_back(std::move(record)); });
  if (!pipeline) return tl::unexpected(pipeline.error());
  (*pipeline)->set_tap(tap);
  QualityMonitor monitor(machine, (*reader)->SamplePeriod());
  ProgressBar progress("reading", "rows");
  SampleBlock block;
  for (;;) {
    const auto rows = (*reader)->Read(block, kRowsPerBlock);
    if (!rows) return tl::unexpected(rows.error());
    if (*rows == 0) break;
    monitor.Inspect(block);
    (*pipeline)->Process(block);
    progress.Update((*reader)->Progress(), (*reader)->counters().rows);
  }
  (*pipeline)->Finish();
  out.totals = (*pipeline)->totals();
  out.discarded_strokes = (*pipeline)->discarded_strokes();
  out.reader = (*reader)->counters();
  out.window = (*pipeline)->window();
  out.model = (*pipeline)->shared_model();
  return out;
}

Result<FitResult> FitLog(const std::string& log, const std::string& machine_file) {
  const auto machine = LoadMachine(machine_file);
  if (!machine) return tl::unexpected(machine.error());
  auto strokes = ReadStrokes(log, *machine);
  if (!strokes) return tl::unexpected(strokes.error());
  auto fit = FitBaseModel(*strokes->model, strokes->Grams(), strokes->window);
  if (!fit) return tl::unexpected(fit.error());
  return FitResult{std::move(*strokes), std::move(*fit)};
}

}  // namespace hydroscope
