#pragma once

#include <Eigen/Dense>

#include "core/records/stroke_gram.h"
#include "estimation/span_equations.h"

namespace hydroscope {

/// Sums the equations of a stroke's spans into its Gram.
class StrokeAccumulator {
 public:
  explicit StrokeAccumulator(int columns);
  void Add(const SpanEquations& span);
  bool empty() const { return blocks_ == 0; }
  /// The stroke's Gram; clears the accumulator.
  StrokeGram Take();

 private:
  Eigen::MatrixXd integral_, noise_, flow_;  ///< lower triangles
  Eigen::MatrixXd packed_;                   ///< equations being added
  std::int64_t blocks_ = 0, spans_ = 0, windows_ = 0;
};

}  // namespace hydroscope
