#pragma once

#include <cstdint>

namespace hydroscope {

struct EnduranceOptions {
  std::int64_t updates = 10'000'000;
  double standstill_hours = 24;
  std::uint64_t seed = 1;
};

/// Long runs. (1) Recursive least squares, equation by equation and in the information form that is the
/// default, with every form of forgetting at lambda 0.999: half of the updates, a standstill of zero and of
/// constant regressors, the other half; value and covariance must stay finite, symmetric, positive and right.
/// (2) The whole pipeline: a log, a standstill streamed row by row at 2 ms, another log; at the standstill
/// nothing may change, and the second log must find the truth. Returns 0 if all of it holds, else 1.
int RunEndurance(const EnduranceOptions& options);

}  // namespace hydroscope
