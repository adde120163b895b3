#include "estimation/states/white_noise.h"

#include <cmath>

namespace hydroscope {

void WhiteNoiseVariance::Add(const Eigen::Ref<const Eigen::VectorXd, 0, Eigen::InnerStride<>>& values,
                             int stride) {
  for (Eigen::Index row = 3 * stride; row < values.size(); ++row) {
    const auto y = [&](int back) { return values[row - back * stride]; };
    const double third = y(0) - 3 * y(1) + 3 * y(2) - y(3);
    if (!std::isfinite(third)) continue;
    energy_ += third * third;
    count_ += 1;
  }
}

double WhiteNoiseVariance::Value() const {
  constexpr double kEnergy = 20;  // 1 + 9 + 9 + 1, of the third difference of white noise
  return count_ > 0 ? energy_ / (kEnergy * count_) : 0;
}

bool AreWhite(const std::vector<RowMatrix>& residuals, int stride) {
  constexpr Eigen::Index kLags = 20;
  constexpr double kMemory = 0.15;
  const Eigen::Index outputs = residuals.empty() ? 0 : residuals.front().cols();
  for (Eigen::Index j = 0; j < outputs; ++j)
    for (Eigen::Index lag = stride; lag <= kLags * stride; lag += stride) {
      double product = 0, energy = 0;
      for (const RowMatrix& residual : residuals)
        for (Eigen::Index row = lag; row < residual.rows(); ++row) {
          const double now = residual(row, j), then = residual(row - lag, j);
          if (!std::isfinite(now) || !std::isfinite(then)) continue;
          product += now * then;
          energy += 0.5 * (now * now + then * then);
        }
      if (std::abs(product) > kMemory * energy) return false;
    }
  return true;
}

}  // namespace hydroscope
