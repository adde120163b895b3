#include "service/fit_log.h"

namespace hydroscope {

Result<FitResult> FitLog(const std::string& log, const std::string& machine_file) {
  auto machine = LoadMachine(machine_file);
  if (!machine) return tl::unexpected(machine.error());
  auto strokes = ReadStrokes(log, *machine, KeepSamples::kYes);
  if (!strokes) return tl::unexpected(strokes.error());
  auto fit = FitFigures(*strokes);
  if (!fit) return tl::unexpected(fit.error());
  const LogTrust trust = JudgeLog(*strokes, fit->theta, fit->noise_floor);
  FitResult out{std::move(*strokes), std::move(*fit), {}, AssumeTolerances(*machine), !trust.rate.fast_enough};
  std::vector<double> speeds;
  for (const StrokeRecord& stroke : out.log.strokes) speeds.push_back(stroke.summary.mean_speed);
  out.confounded =
      ConfoundingsOf(out.log.machine, out.log.model, out.log.Grams(), out.log.window, speeds, out.fit);
  MarkConfounded(out.confounded, out.fit);
  return out;
}

}  // namespace hydroscope
