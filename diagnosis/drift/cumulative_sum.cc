#include "diagnosis/drift/cumulative_sum.h"

#include <algorithm>
#include <cmath>

#include "diagnosis/drift/drift_thresholds.h"

namespace hydroscope::drift {

void CumulativeSum::Add(std::int64_t sequence, double deviation, double std, double doubt,
                        const DriftSize& size) {
  if (!(std > 0) || !std::isfinite(std) || !std::isfinite(deviation) || !std::isfinite(doubt)) return;
  const double tolerance = (0.5 * size.smallest + 2.0 * doubt) / std;
  const double shift = std::min(size.smallest / std, kDriftThresholds.largest_shift);
  const double z = deviation / std;
  const auto step = [&](double signed_z, double& sum, std::int64_t& from) {
    sum += shift * std::clamp(signed_z - tolerance, -kDriftThresholds.clip, kDriftThresholds.clip) -
           shift * shift / 2;
    if (sum > 0) {
      sum = std::min(
          sum, 2 * kDriftThresholds.cusum);  // so that a return to normal is seen as fast as the drift was
      return;
    }
    sum = 0;
    from = sequence;
  };
  step(z, up_, up_from_);
  if (!size.only_upwards) step(-z, down_, down_from_);
}

int CumulativeSum::Direction() const {
  if (up_ >= kDriftThresholds.cusum && up_ >= down_) return 1;
  return down_ >= kDriftThresholds.cusum ? -1 : 0;
}

void CumulativeSum::Reset(std::int64_t sequence) {
  up_ = down_ = 0;
  up_from_ = down_from_ = sequence;
}

}  // namespace hydroscope::drift
