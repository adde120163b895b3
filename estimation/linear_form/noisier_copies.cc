#include "estimation/linear_form/noisier_copies.h"

#include <array>
#include <cmath>
#include <random>

namespace hydroscope {

Eigen::VectorXd WhiteNoiseOfSignals(std::span<const Episode> episodes) {
  constexpr std::array<double, 7> kSixth = {1, -6, 15, -20, 15, -6, 1};
  constexpr double kEnergy = 924;  // of the weights, squared
  const Eigen::Index signals = episodes.empty() ? 0 : episodes.front().signal.cols();
  Eigen::VectorXd noise = Eigen::VectorXd::Zero(signals);
  for (Eigen::Index s = 0; s < signals; ++s) {
    double energy = 0, count = 0;
    for (const Episode& e : episodes)
      for (int row = 0; row + 6 < e.rows(); ++row) {
        double difference = 0;
        for (int k = 0; k < 7; ++k) difference += kSixth[k] * e.signal(row + k, s);
        if (!std::isfinite(difference)) continue;
        energy += difference * difference;
        count += 1;
      }
    if (count > 0) noise[s] = std::sqrt(energy / (kEnergy * count));
  }
  return noise;
}

std::vector<std::vector<Episode>> NoisierCopies(std::span<const Episode> episodes,
                                                const Eigen::VectorXd& noise, int pairs, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::vector<std::vector<Episode>> copies;
  for (int k = 0; k < pairs; ++k) {
    std::vector<Episode> more(episodes.begin(), episodes.end()), less = more;
    for (std::size_t e = 0; e < episodes.size(); ++e)
      for (int row = 0; row < episodes[e].rows(); ++row)
        for (Eigen::Index s = 0; s < noise.size(); ++s) {
          const double draw = noise[s] * normal(random);
          more[e].signal(row, s) += draw;
          less[e].signal(row, s) -= draw;
        }
    copies.push_back(std::move(more));
    copies.push_back(std::move(less));
  }
  return copies;
}

}  // namespace hydroscope
