#pragma once

#include <Eigen/Dense>

#include "core/records/stroke_gram.h"
#include "estimation/span_equations.h"

namespace hydroscope {

/// Sums the equations of a stroke's spans into its Gram.
class StrokeAccumulator {
 public:
  explicit StrokeAccumulator(int columns) : StrokeAccumulator(0, columns) {}
  /// For `columns` that stand behind `known` others, whose Gram is known.
  StrokeAccumulator(int known, int columns);
  void Add(const SpanEquations& span) { Add(SpanEquations(), span); }
  /// `known`: equations of the same span, of the columns before.
  void Add(const SpanEquations& known, const SpanEquations& span);
  bool empty() const { return blocks_ == 0; }
  /// The stroke's Gram; clears the accumulator.
  StrokeGram Take() { return Take(StrokeGram()); }
  /// `known`: that of the columns before.
  StrokeGram Take(const StrokeGram& known);

 private:
  /// A column for each own one; rows are its products with the own ones, from itself on, and then with those known.
  Eigen::MatrixXd integral_, noise_, flow_;
  Eigen::MatrixXd packed_;  ///< equations being added
  std::int64_t blocks_ = 0, spans_ = 0, windows_ = 0;
};

}  // namespace hydroscope
