#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/records/sample_block.h"
#include "core/records/stroke_record.h"
#include "core/result.h"
#include "models/machine.h"
#include "models/machine_kind.h"

namespace hydroscope {

/// Sizes that no hydraulic machine has: a unit, a scale or a piece of geometry in the machine file is wrong,
/// and whatever was concluded would be wrong with it. Looks at the readings of a log as they pass, in means
/// of a few rows, so that spikes and noise do not count. What a slow beginning of a log lacks (pressure,
/// travel, speed) may still come: the judgement is of what was seen so far.
class SizeWatch {
 public:
  /// `sample_period` in s.
  SizeWatch(const Machine& machine, double sample_period);
  void Observe(const SampleBlock& block);
  /// Error kBadInput that names signal, value found, plausible range and what to change.
  Status Judge() const;

 private:
  struct Range;
  Range Seen(std::size_t signal) const;
  Status JudgeSignal(std::size_t signal) const;
  Status JudgeSign(std::size_t signal) const;
  Status JudgeTravel(const MachineInput& length) const;
  Status JudgeSpeed(const Condition& speed, std::size_t signal) const;
  std::optional<double> TopSpeed(std::size_t signal) const;
  bool Works() const;

  const Machine& machine_;
  double piece_time_;                       ///< s from one mean to the next
  std::vector<double> sum_;                 ///< of the piece under way
  std::size_t rows_ = 0;                    ///< in the piece under way
  std::vector<std::vector<double>> means_;  ///< SI, per signal; NaN where a reading was missing
};

/// The same of areas and pressures that the machine file states.
Status JudgeGeometry(const Machine& machine);

/// Geometry, then the readings of a log as far as it takes to see plausible sizes.
Status JudgeSizes(const std::string& log, const Machine& machine);

/// Of strokes in a database: what they were driven at.
Status JudgeStrokes(const std::string& database, const Machine& machine,
                    std::span<const StrokeSummary> strokes);

}  // namespace hydroscope
