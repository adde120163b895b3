#include "diagnosis/experiment/played_stroke.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "machines/die_cushion/balance.h"

namespace hydroscope {
namespace {

constexpr double kStepTime = 0.05;      ///< s, time constant of a pressure step
constexpr double kUsableOpening = 0.8;  ///< pressures are raised so that less is enough

}  // namespace

StrokeStretches Play(const ModelStructure& model, const Eigen::VectorXd& theta, const WindowSamples& window,
                     const MachineMoves& moves, const PlayedStroke& played, SensorNoise sensors) {
  const double period = window.period;
  const int samples = static_cast<int>(moves.stroke / played.speed / period),
            span = window.span * window.block;
  const double least = std::pow(model.piston_area * played.speed / (kUsableOpening * std::abs(theta[0])), 2);
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  const auto noise = [&](double std) { return sensors == SensorNoise::kNone ? 0.0 : std * normal(random); };
  StrokeStretches out;
  double p = std::max(least, played.pressures.front());
  for (int first = 0; first + span <= samples; first += span) {
    Stretch stretch;
    stretch.period = period;
    stretch.samples = span;
    stretch.begin = played.begin + first * period;
    stretch.channel.assign(model.channel_names.size(), std::vector<double>(span, 0.0));
    bool open = true;
    for (int k = 0; k < span; ++k) {
      const std::size_t phase = played.pressures.size() * static_cast<std::size_t>(first + k) / samples;
      const double rate = (std::max(least, played.pressures[phase]) - p) / kStepTime;
      p += rate * period;
      const double z = moves.stroke - played.speed * (first + k) * period, root = std::sqrt(p);
      // A dz/dt = theta1 root y + (theta2 + theta3 z) dp/dt + theta4 root, solved for y.
      const double y =
          (-model.piston_area * played.speed - (theta[1] + theta[2] * z) * rate - theta[3] * root) /
          (theta[0] * root);
      open = open && y > moves.min_opening && y < 1.0;
      stretch.channel[kPressureA][k] = p + noise(moves.p_noise);
      stretch.channel[kPosition][k] = z + noise(moves.z_noise);
      stretch.channel[kSpool][k] = y + noise(moves.y_noise);
      stretch.channel[kPressureB][k] = played.rod;
      stretch.channel[kSupplyPressure][k] = moves.supply;
      stretch.channel[kOilTemperature][k] = played.oil;
    }
    if (open) out.push_back(std::move(stretch));
  }
  return out;
}

}  // namespace hydroscope
