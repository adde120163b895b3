#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/records/sample_block.h"
#include "core/records/stroke_record.h"
#include "estimation/episode.h"
#include "models/episode_marker.h"
#include "models/machine.h"

namespace hydroscope {

/// Signals of a machine that its episodes hang on, indices.
struct EpisodeSignals {
  std::vector<int> inputs;   ///< without a good reading of all a row is none
  std::vector<int> outputs;  ///< readings that are not good are left out
};

/// Cuts rows of a machine into episodes, row by row: an episode ends at a row without a good reading of an input,
/// at a gap or a step of the clock, where Machine::episode_marker changes and where [gate] has not held for its gap. Outputs
/// that are no good readings are left out. Readings that repeat or stand out count as good on inputs, which may rest and jump.
class EpisodeCutter {
 public:
  static constexpr std::size_t kLeastRows = 10;  ///< of an episode
  /// No faults of an input, which may rest, jump and be drawn by a logger.
  static constexpr Quality kFineOnInputs = quality::kSpike | quality::kStuck | quality::kInterpolated;
  struct Options {
    double period = 0;  ///< s
    int log = 0;
    /// Whole logs: pieces longer than [episodes] seconds are cut into equal parts. Else rows come one after the other without
    /// end, and an episode is over as soon as it is so long.
    bool whole = false;
    /// Of an episode of an endless row of rows, where nothing else ends it.
    std::int64_t most_rows = 100'000;
  };
  using Sink = std::function<void(Episode&&, const StrokeCounters&)>;

  /// Error: a rate in [gate].
  static Status Check(const Machine& machine);
  /// `machine` must outlive it.
  EpisodeCutter(const Machine& machine, EpisodeSignals signals, const Options& options, Sink sink);

  /// Whether readings of a signal that repeat one count as stuck (quality::kStuck): not where its `stuck_time` is a few rows only.
  static bool JudgesStuck(const SignalSpec& signal, double period);

  /// Flags of readings that stand out are forgiven a signal that is full of them: of the whole log, if this is called with
  /// their share per signal, else of each episode.
  void ForgiveSpikes(const std::vector<double>& share);
  void Process(const SampleBlock& block);
  void Finish();

  const StrokeCounters& totals() const { return totals_; }
  /// Pieces that were too short.
  std::int64_t discarded() const { return discarded_; }
  /// Steps of the clock, a sentence each; the first ten.
  const std::vector<Told>& warnings() const { return warnings_; }
  /// s for which [gate] has not held.
  double outside() const { return outside_; }

 private:
  /// Rows kept of the episode under way.
  struct Rows {
    std::vector<double> time;
    std::vector<std::vector<double>> signal;
    std::vector<std::vector<Quality>> quality;
    std::int64_t first = 0;  ///< of the log

    std::size_t size() const { return time.size(); }
    void Clear();
  };
  void TakeRow(const SampleBlock& block, std::size_t row);
  bool BreaksTime(const SampleBlock& block, std::size_t row) const;
  bool InputsGood(const SampleBlock& block, std::size_t row) const;
  bool InGate(const SampleBlock& block, std::size_t row);
  void End();
  bool AtAngles(Episode& episode);
  Quality Forgiven(std::size_t signal) const;
  void Emit(std::size_t first, std::size_t end, const std::vector<Quality>& forgiven);

  const Machine& machine_;
  EpisodeSignals signals_;
  Options options_;
  Sink sink_;
  EpisodeMarker marker_;
  std::vector<bool> input_;     ///< per signal: without a good reading of it a row is none
  int driven_ = -1;             ///< output of a closed loop, which never rests while its set point moves
  int shaft_ = -1;              ///< signal of StatesSpec::shaft
  std::vector<double> spikes_;  ///< share per signal, empty: of each episode
  Rows rows_;
  std::optional<double> last_time_;
  std::int64_t row_ = 0;  ///< of the log
  double outside_ = 0;
  StrokeCounters totals_, present_;
  std::int64_t discarded_ = 0;
  std::vector<Told> warnings_;
};

}  // namespace hydroscope
