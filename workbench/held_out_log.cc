#include "workbench/held_out_log.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "core/counted_words.h"
#include "core/short_number.h"
#include "core/told_error.h"
#include "diagnosis/remainder/residuals.h"
#include "diagnosis/sample_grams.h"
#include "pipeline/raw_log.h"

namespace hydroscope {

Result<LogChoice> ChooseLogs(const std::vector<std::string>& logs, const std::string& hold_out) {
  LogChoice out{logs, hold_out};
  if (hold_out.empty()) return out;
  const auto is_meant = [&](const std::string& log) {
    return log == hold_out || std::filesystem::path(log).filename() == hold_out;
  };
  const auto count = std::ranges::count_if(logs, is_meant);
  if (count > 1)
    return UsageError("--hold-out {}: {} of the logs have this name; give the path", hold_out, count);
  if (count == 1) out.held_out = *std::ranges::find_if(logs, is_meant);
  std::erase_if(out.fitted, is_meant);
  if (out.fitted.empty()) return UsageError("--hold-out {}: no other log is left to fit to", hold_out);
  std::vector<std::string> all = out.fitted;
  all.push_back(out.held_out);
  TRY(JudgeDistinct(all));
  return out;
}

Result<HeldOutError> ErrorOnLog(const MachineModel& model, const LogStrokes& held_out,
                                const std::string& log) {
  Eigen::VectorXd error = ColumnWeights(*model.structure, model.fit);
  error[model.structure->output_column()] -= 1;
  HeldOutError out{log, static_cast<int>(held_out.stretches.size()), 0};
  double squared = 0, windows = 0;
  for (const StrokeGram& gram : GramsOf(model.structure, held_out.stretches, held_out.window)) {
    squared += error.dot(Unpacked(gram.flow) * error);
    windows += static_cast<double>(gram.windows);
  }
  if (!(windows > 0))
    return BadInput(Tell("{}: no strokes inside the gate to judge the model on",
                         "{}: keine Hübe im Gate, an denen das Modell beurteilt werden könnte", log));
  out.rms = std::sqrt(std::max(0.0, squared / windows));
  return out;
}

Result<HeldOutError> ErrorHeldOut(const LogStrokes& fitted, const LogStrokes& held_out,
                                  const std::string& log) {
  const auto model = TRY(FitMachineModel(fitted));
  return ErrorOnLog(model, held_out, log);
}

Result<HeldOutError> ErrorHeldOut(const LogStrokes& fitted, const std::string& log) {
  const auto held_out = TRY(ReadStrokes(log, fitted.machine, KeepSamples::kYes));
  return ErrorHeldOut(fitted, held_out, log);
}

std::string HeldOutText(const HeldOutError& error, const DisplayUnit& unit) {
  return fmt::format("error on {}, held out: {} {}, {}\n", error.log, ShortNumber(error.rms * unit.factor),
                     unit.name, Counted(error.strokes, "stroke"));
}

nlohmann::json HeldOutJson(const HeldOutError& error, const DisplayUnit& unit) {
  return {
      {"log", error.log}, {"strokes", error.strokes}, {"rms", error.rms * unit.factor}, {"unit", unit.name}};
}

}  // namespace hydroscope
