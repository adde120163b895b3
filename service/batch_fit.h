#pragma once

#include <string>
#include <vector>

#include "core/result.h"
#include "core/stroke_record.h"
#include "estimation/gram_fit.h"
#include "models/machine.h"
#include "replay/log_reader.h"
#include "service/pipeline.h"

namespace hydroscope {

/// A log sent through the pipeline once, with everything it left behind.
struct LogStrokes {
  Machine machine;
  std::vector<StrokeRecord> strokes;
  StrokeCounters totals;
  std::int64_t discarded_strokes = 0;
  LogCounters reader;
  WindowSamples window;
  std::shared_ptr<const ModelStructure> model;

  std::vector<StrokeGram> Grams() const;
};

/// Reads a whole log through quality monitor and pipeline; progress on stderr. `tap` may be empty.
Result<LogStrokes> ReadStrokes(const std::string& log, const Machine& machine, const Pipeline::EquationTap& tap = {});

struct FitResult {
  LogStrokes log;
  GramFit fit;
};

/// `hydroscope fit`: every stroke of the log weighs the same.
Result<FitResult> FitLog(const std::string& log, const std::string& machine_file);

}  // namespace hydroscope
