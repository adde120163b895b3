#include "workbench/fit_log.h"

namespace hydroscope {
namespace {

/// Strokes too few or too much alike for `explain`.
Result<FitResult> FitUnexplained(LogStrokes strokes, FitSuspicion suspicion) {
  FitResult out{std::move(strokes), {}, std::move(suspicion)};
  out.fit = TRY(FitFigures(out.log));
  out.trust = JudgeLog(out.log, out.fit.theta, out.fit.noise_floor);
  for (Told& warning : out.trust.Warnings()) out.suspicion.warnings.push_back(std::move(warning));
  out.suspicion.warnings.insert(out.suspicion.warnings.end(), out.log.swapped.begin(), out.log.swapped.end());
  out.suspicion.warnings.insert(out.suspicion.warnings.end(), out.log.doubts.begin(), out.log.doubts.end());
  out.confounded = ConfoundingsOf(out.log, out.log.machine.added_effects, out.fit.parameters);
  MarkConfounded(out.confounded, out.fit.parameters);
  return out;
}

}  // namespace

Result<FitResult> FitStrokes(LogStrokes strokes) {
  auto explained = ExplainStrokes(strokes);
  FitSuspicion suspicion = SuspicionOf(explained);
  if (!explained) return FitUnexplained(std::move(strokes), std::move(suspicion));
  return FitResult{std::move(explained->log), std::move(explained->base), std::move(suspicion),
                   explained->trust, std::move(explained->confounded)};
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
