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

}  // namespace hydroscope
