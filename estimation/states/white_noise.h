#pragma once

#include <Eigen/Dense>
#include <vector>

#include "estimation/episode.h"

namespace hydroscope {

/// Variance of the white noise in a series from its third differences: what moves evenly over four readings leaves nothing in
/// them. At most, that is: what moves faster counts as noise.
class WhiteNoiseVariance {
 public:
  /// A further piece of the series, NaN where nothing was measured; readings `stride` rows apart.
  void Add(const Eigen::Ref<const Eigen::VectorXd, 0, Eigen::InnerStride<>>& values, int stride);
  /// Differences seen; 0 = nothing is known.
  double count() const { return count_; }
  double Value() const;

 private:
  double energy_ = 0, count_ = 0;
};

/// Whether no column remembers itself: correlations over 1 ... 20 readings, `stride` rows apart, stay below 0.15.
bool AreWhite(const std::vector<RowMatrix>& residuals, int stride);

}  // namespace hydroscope
