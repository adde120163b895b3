#pragma once

#include <string>
#include <vector>

#include "core/records/stroke_record.h"
#include "core/result.h"
#include "diagnosis/extended_fit.h"
#include "estimation/gram_fit.h"
#include "models/machine.h"
#include "models/stretch.h"
#include "pipeline/geometry_tolerance.h"
#include "pipeline/log_faults/reading_faults.h"
#include "pipeline/pipeline.h"
#include "replay/log_reader.h"

namespace hydroscope {

/// A log sent through the pipeline once, with everything it left behind.
struct LogStrokes {
  Machine machine;
  std::vector<StrokeRecord> strokes;
  StrokeCounters totals;
  std::int64_t discarded_strokes = 0;
  std::vector<std::string> log_names;  ///< file names of these, in order; empty: of a database
  int logs = 1;                        ///< taken together; StrokeGram::log and Stretch::log count them
  LogCounters reader;
  WindowSamples window;
  std::shared_ptr<const ModelStructure> model;
  std::vector<std::string> notes;  ///< what should be known of the logs, one sentence each
  std::vector<ReadingFaults::Echo> echoes;
  std::vector<Told> swapped;  ///< LogPass::swapped, BrokenUp, with the log: no verdict on these strokes
  std::vector<Told> doubts;   ///< LogPass::reversed and wrong_answers, with the log
  Told stuck;                 ///< StuckSignal, of the first log of which there is something to say
  std::vector<StrokeStretches> stretches;  ///< per stroke, as far as kMaxKeptSamples reach; only if asked for

  std::vector<StrokeGram> Grams() const;
};

/// Strokes below which held-out errors and intervals clustered by stroke say nothing.
inline constexpr std::size_t kMinExplainStrokes = 4;

/// Whether to keep the gated samples in memory, for refining effects and for locating errors. Thinned: of
/// very many strokes only every second, fourth, ... is kept, with its samples, so that memory stays bounded
/// for any log.
enum class KeepSamples { kNo, kYes, kThinned };
/// Samples kept at most, some 150 MB.
inline constexpr std::int64_t kMaxKeptSamples = 2'000'000;
/// Strokes kept at most when thinned.
inline constexpr std::size_t kMaxThinnedStrokes = 2000;

/// Collects what a pipeline says into LogStrokes.
class StrokeCollector {
 public:
  StrokeCollector(const Machine& machine, KeepSamples keep);
  Pipeline::RecordSink Sink();
  Pipeline::EquationTap Tap();
  /// Takes totals from the finished pipeline and hands everything over.
  LogStrokes Finish(const Pipeline& pipeline);

 private:
  void Keep(StrokeRecord&& record);
  void Thin();

  LogStrokes out_;
  KeepSamples keep_;
  std::int64_t stride_ = 1;
  std::int64_t kept_ = 0;
  std::int64_t pending_samples_ = 0;
  std::vector<std::pair<double, Stretch>> pending_;  ///< stretches with their begin, stroke not over yet
};

/// Reads a whole log through quality monitor and pipeline; progress on stderr.
Result<LogStrokes> ReadStrokes(const std::string& log, const Machine& machine,
                               KeepSamples keep = KeepSamples::kNo);

/// Takes up the strokes of a further log of the same machine and sampling, as if recorded in a row: numbers, times and
/// Stretch::log go on.
void Append(LogStrokes next, LogStrokes& all);

/// The same for several logs of one machine, one after the other as if recorded in a row. Logs whose sampling rate is
/// nearly that of the first are interpolated (replay/resampled_reader.h). Errors: it is not even nearly the same,
/// a log is given twice.
Result<LogStrokes> ReadStrokes(const std::vector<std::string>& logs, const Machine& machine,
                               KeepSamples keep = KeepSamples::kNo);

}  // namespace hydroscope
