#include "core/records/estimate_statement.h"

#include <gtest/gtest.h>

#include <cmath>

namespace hydroscope {
namespace {

TEST(EstimateStatement, WidensByWhatAllStrokesShareAndToNoLessThanTheFit) {
  const std::vector<EstimateStatement> statements = {
      {.parameter = "V0", .shared = 0.005, .why = {}},
      {.parameter = "K", .least_std = 3e6, .confounded = true, .why = Told("a leak")}};
  Estimate v{"V0", 2e-3, 1e-5, "m3", 1, 0, EstimateReason::kUpdated};
  StateEstimate(statements, v);
  EXPECT_NEAR(v.std, std::hypot(1e-5, 1e-5), 1e-12);
  EXPECT_EQ(v.reason, EstimateReason::kUpdated);
  Estimate k{"K", 1.2e9, 2e6, "Pa", 1, 0, EstimateReason::kUpdated};
  StateEstimate(statements, k);
  EXPECT_EQ(k.std, 3e6);
  EXPECT_EQ(k.reason, EstimateReason::kConfounded);
  k.reason = EstimateReason::kNotExcited;
  StateEstimate(statements, k);
  EXPECT_EQ(k.reason, EstimateReason::kNotExcited) << "why it is old says more";
  Estimate q{"Q_vn", 1.6e-3, 2e-6, "m3/s", 1, 0, EstimateReason::kUpdated};
  StateEstimate(statements, q);
  EXPECT_EQ(q.std, 2e-6);
}

}  // namespace
}  // namespace hydroscope
