#pragma once

#include <memory>
#include <vector>

#include "core/records/sample_block.h"
#include "models/expressions/evaluator.h"
#include "models/machine.h"

namespace hydroscope {

/// Finds rows on which an expression of the machine file is no finite number (division by zero, root of a
/// negative value, overflow), so that they are flagged and counted like any bad reading. A rate counts as 1
/// and as -1: what is done with it has been found finite for any value when the file was read. Constants that
/// are found from the data stand at both their limits.
class ExpressionGuard {
 public:
  /// nullptr if no expression of the machine can fail.
  static std::shared_ptr<const ExpressionGuard> For(const Machine& machine);

  /// Adds quality::kExpression to the first signal that the expression reads. Rows with another flag on one
  /// of its signals are left as they are.
  void Flag(SampleBlock& block, std::size_t rows) const;

 private:
  void Watch(const Machine& machine, const Expression& expression);
  std::vector<std::unique_ptr<const ExpressionEvaluator>> watched_;
};

}  // namespace hydroscope
