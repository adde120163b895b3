#include "workbench/fit_log.h"

namespace hydroscope {
namespace {

Result<FitResult> FitAndSuspect(LogStrokes strokes) {
  auto explained = ExplainStrokes(strokes);
  FitSuspicion suspicion = SuspicionOf(explained);
  if (explained)
    return FitResult{std::move(explained->log), std::move(explained->base), std::move(suspicion),
                     explained->trust};
  auto fit = TRY(FitFigures(strokes));
  const LogTrust trust = JudgeLog(strokes, fit.theta, fit.noise_floor);
  for (Told& warning : trust.Warnings()) suspicion.warnings.push_back(std::move(warning));
  suspicion.warnings.insert(suspicion.warnings.end(), strokes.swapped.begin(), strokes.swapped.end());
  return FitResult{std::move(strokes), std::move(fit), std::move(suspicion), trust};
}

}  // namespace

Result<FitResult> FitStrokes(LogStrokes strokes) {
  auto out = FitAndSuspect(std::move(strokes));
  if (!out) return out;
  std::vector<ConditionRange> ranges;
  for (const StrokeRecord& stroke : out->log.strokes)
    IncludeStroke(out->log.model->conditions, stroke.summary, ranges);
  out->confounded =
      ConfoundingsOf(out->log.machine, out->log.model, out->log.Grams(), out->log.window, ranges, out->fit);
  MarkConfounded(out->confounded, out->fit);
  return out;
}

Result<FitResult> FitLogs(const std::vector<std::string>& logs, const std::string& machine_file,
                          const std::string& hold_out) {
  auto machine = TRY(LoadMachine(machine_file));
  const auto chosen = TRY(ChooseLogs(logs, hold_out));
  auto strokes = TRY(ReadStrokes(chosen.fitted, machine, KeepSamples::kYes));
  auto out = FitStrokes(std::move(strokes));
  if (!out) return out;
  out->assumed = AssumeTolerances(machine);
  if (chosen.held_out.empty()) return out;
  out->held_out = TRY(ErrorHeldOut(out->log, chosen.held_out));
  return out;
}

}  // namespace hydroscope
