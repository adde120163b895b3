#pragma once

#include <span>
#include <vector>

#include "core/records/stroke_record.h"
#include "models/model_structure.h"

namespace hydroscope {

/// What a stroke was driven at: ModelStructure::conditions and the mean temperature, from the means of its blocks.
class StrokeConditions {
 public:
  explicit StrokeConditions(const ModelStructure& model);

  /// A stroke begins.
  void Begin();
  /// A block of `rows` samples inside the gate: `samples` of channel c from c * rows on.
  void Add(std::span<const double> samples, int rows);
  /// The next block does not follow the last one.
  void Break();
  /// Into the summary of the stroke that ends; `gated_time` in s.
  void Write(double gated_time, StrokeSummary& summary) const;

 private:
  struct Course {
    int channel = -1;
    Condition::Of of = Condition::Of::kMean;
    double sum = 0, blocks = 0, largest = 0, travel = 0, last = 0;

    void Add(double mean);
    double Value(double gated_time) const;
  };

  std::vector<Course> courses_;  ///< of the conditions, then of the temperature
};

}  // namespace hydroscope
