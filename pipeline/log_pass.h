#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "acquisition/quality_monitor.h"
#include "pipeline/log_faults/cut_off.h"
#include "pipeline/log_faults/frozen_pressure.h"
#include "pipeline/log_faults/reading_faults.h"
#include "pipeline/pipeline.h"
#include "pipeline/run_summary.h"
#include "replay/log_reader.h"

namespace hydroscope {

/// What one pass of a log through quality monitor and pipeline left behind, besides the strokes.
struct LogPass {
  RunSummary summary;
  std::vector<ChannelQuality> channels;  ///< one per signal of the machine
  std::int64_t copied_rows = 0;          ///< flagged as repeating earlier ones (acquisition/repeated_rows.h)
  Told no_verdict;                       ///< ReadingFaults::NoVerdict
  std::vector<ReadingFaults::Echo> echoes;
  std::vector<Told> swapped;           ///< SwappedPressures::Sentences
  std::vector<Told> outside_declared;  ///< DeclaredRanges::Sentences
  std::vector<Told> reversed;          ///< CommandAnswers::Against
  std::vector<Told> wrong_answers;     ///< CommandAnswers::Sizes
  std::vector<CutOff> cut_offs;        ///< those that were known, else those seen
  std::vector<FrozenStretch> frozen;   ///< the same
  std::vector<Told> known_texts;       ///< LogPassHooks::known_texts

  /// Whether a pass that knows of these would leave out more readings.
  bool WouldLeaveOutMore() const { return !cut_offs.empty() || !frozen.empty(); }
  /// Sentences on cut-off and frozen readings.
  std::vector<Told> LeftOut(const Machine& machine) const;
};

struct LogPassHooks {
  /// Sees every block before the pipeline, flags set.
  std::function<void(const SampleBlock&)> observe;
  /// Runs after every block; an error ends the pass.
  std::function<Status()> after_block;
  /// Whether to look for what no source sent: rows that repeat earlier ones, readings drawn between others. The live service does
  /// not look for them, nor does what replays it bit by bit.
  bool distrust_logger = true;
  /// Of an earlier pass over the same log: readings beyond are flagged from the first one on.
  std::vector<CutOff> known_cut_offs;
  std::vector<FrozenStretch> known_frozen;  ///< the same, flagged kStuck
  std::vector<FrozenStretch> known_hung;    ///< of inputs, whose readings are taken out (HungInputs)
  std::vector<Told> known_texts;            ///< what was said of it, for LogPass::LeftOut
  std::int64_t most_rows = std::numeric_limits<std::int64_t>::max();  ///< the pass ends behind these
};

/// What the monitor saw of each channel, into pass.channels and the summary.
void TakeChannels(const QualityMonitor& monitor, const Machine& machine, LogPass& pass);

/// Sends the whole log through monitor and pipeline, progress on stderr under the name `what`. A log that
/// cannot be read to its end counts up to there: RunSummary::stopped says why. Without a
/// pipeline (nullptr) the signals are judged only.
Result<LogPass> PassLog(LogReader& reader, const Machine& machine, Pipeline* pipeline,
                        const std::string& what, const LogPassHooks& hooks = {});

}  // namespace hydroscope
