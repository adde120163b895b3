#include "core/records/estimate_statement.h"

#include <algorithm>
#include <cmath>

namespace hydroscope {

const EstimateStatement* FindStatement(const std::vector<EstimateStatement>& statements,
                                       const std::string& parameter) {
  const auto found = std::ranges::find(statements, parameter, &EstimateStatement::parameter);
  return found == statements.end() ? nullptr : &*found;
}

void StateEstimate(const std::vector<EstimateStatement>& statements, Estimate& estimate) {
  const EstimateStatement* statement = FindStatement(statements, estimate.parameter);
  if (statement == nullptr) return;
  if (statement->shared > 0) estimate.std = std::hypot(estimate.std, statement->shared * estimate.value);
  estimate.std = std::max(estimate.std, statement->least_std);
  if (statement->confounded && estimate.reason == EstimateReason::kUpdated)
    estimate.reason = EstimateReason::kConfounded;
}

}  // namespace hydroscope
