#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "estimation/floor_trust.h"
#include "estimation/sampling_rate.h"
#include "pipeline/batch_fit.h"
#include "replay/log_reader.h"

namespace hydroscope {

/// What makes every conclusion from a log doubtful, whatever the model says: noise that is not as the noise
/// floor takes it, and rows too far apart.
struct LogTrust {
  FloorTrust floor;
  SamplingRate rate;

  /// Sentences for `warnings`, the gravest first; none if nothing is doubtful.
  std::vector<Told> Warnings() const;
};

/// Judges the kept samples of a log by the base balance `theta` (SI, regression parameters); `noise_floor` in
/// SI of the output, as FitBaseModel gives it. Without samples nothing is doubted.
LogTrust JudgeLog(const LogStrokes& log, const Eigen::VectorXd& theta, double noise_floor);

/// The same with a fit of the base balance to those strokes; without one nothing is doubted.
LogTrust JudgeStrokes(const LogStrokes& log);

/// The first strokes of a log with their samples, taken from a pipeline that keeps none, to judge the log by.
class FirstStrokes {
 public:
  explicit FirstStrokes(const Machine& machine);

  /// For the pipeline's tap and its sink.
  void AddStretch(const Stretch& stretch, const SpanEquations& equations);
  void AddStroke(const StrokeRecord& record);
  /// Whether no further one is taken.
  bool complete() const;
  /// Once, when the pipeline has finished.
  LogStrokes Finish(const Pipeline& pipeline) { return strokes_.Finish(pipeline); }

 private:
  StrokeCollector strokes_;
  Pipeline::EquationTap tap_;
  Pipeline::RecordSink sink_;
  int taken_ = 0;
};

/// The first strokes of rows that carry their flags already, such as those of a raw window; rows behind them are not read.
Result<LogStrokes> FirstStrokesOf(LogReader& reader, const Machine& machine);
Result<LogTrust> JudgeRows(LogReader& reader, const Machine& machine);

/// `believable`, `noise_scale`, `signals`: list of `signal`, `kind`, `unit` (SI), `std`, `stated`, `ratio`,
/// `ratio_interval95`, `share`.
nlohmann::json NoiseJson(const FloorTrust& floor);
/// `fast_enough`, `period_s`, `needed_period_s`, `error`, `allowed` in the display unit of the model's output.
nlohmann::json SamplingJson(const SamplingRate& rate, const ModelStructure* model);

/// "WARNING: ...\n" for each.
std::string WarningsText(const std::vector<std::string>& warnings);

}  // namespace hydroscope
