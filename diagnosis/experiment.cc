#include "diagnosis/experiment.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "estimation/stroke_accumulator.h"
#include "models/die_cushion.h"

namespace hydroscope {
namespace {

constexpr double kNeeded = 150.0;     ///< noise variances between rivals that settle a case
constexpr int kMinStrokes = 12;       ///< fewer give no interval worth the name
constexpr int kMaxStrokes = 60;       ///< more than this is no test but a campaign
constexpr double kStepTime = 0.05;    ///< s, time constant of a pressure step
constexpr double kRodPressure = 60e5; ///< Pa, rod side of the strokes played through

/// Plays one stroke through: pressures in equal parts of the stroke, the spool where the base balance wants it.
StrokeStretches PlayStroke(const ModelStructure& model, const Eigen::VectorXd& theta, const WindowSamples& window,
                           double speed, std::span<const double> pressures, double oil, double stroke) {
  const double period = window.period;
  const int samples = static_cast<int>(stroke / speed / period);
  const int span = window.span * window.block;
  StrokeStretches out;
  double p = pressures.front();
  Stretch stretch;
  for (int k = 0; k < samples; ++k) {
    if (k % span == 0) {
      if (stretch.samples == span) out.push_back(stretch);
      stretch = Stretch{};
      stretch.period = period;
      stretch.channel.assign(model.channel_names.size(), std::vector<double>(span, 0.0));
    }
    const std::size_t phase = std::min(pressures.size() - 1, pressures.size() * static_cast<std::size_t>(k) / samples);
    const double rate = (pressures[phase] - p) / kStepTime;
    p += rate * period;
    const double z = stroke - speed * k * period;
    const double root = std::sqrt(p);
    // A dz/dt = theta1 root y + (theta2 + theta3 z) dp/dt + theta4 root, solved for y.
    const double y = (-model.piston_area * speed - (theta[1] + theta[2] * z) * rate - theta[3] * root) / (theta[0] * root);
    const int at = stretch.samples++;
    stretch.channel[kPressureA][at] = p;
    stretch.channel[kPosition][at] = z;
    stretch.channel[kSpool][at] = y;
    stretch.channel[kPressureB][at] = kRodPressure;
    stretch.channel[kSupplyPressure][at] = 210e5;
    stretch.channel[kOilTemperature][at] = oil;
  }
  return out;
}

/// Energy of effect `a` at its fitted size in `played` that the base columns and rival `b`, at whatever size, cannot
/// take over.
double Separation(const StrokeSet& recorded, const Eigen::MatrixXd& played, const RankedEffect& a, const RankedEffect& b) {
  const ModelStructure& model = recorded.model();
  const int base = model.base_count;
  const EffectEstimate& size = a.fit.effects.back();
  const Eigen::VectorXd effect = recorded.Direction(size.choice, a.fit.theta) * size.size;
  Eigen::MatrixXd regressors = Eigen::MatrixXd::Zero(model.column_count(), base + 1);
  regressors.topLeftCorner(base, base).setIdentity();
  regressors.col(base) = recorded.Direction(b.fit.effects.back().choice, b.fit.theta);
  const Eigen::MatrixXd h = regressors.transpose() * played * regressors;
  const Eigen::VectorXd cross = regressors.transpose() * played * effect;
  const Eigen::VectorXd scale = h.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = scale.asDiagonal() * h * scale.asDiagonal();
  const Eigen::VectorXd weighted = scale.asDiagonal() * cross;
  return std::max(0.0, effect.dot(played * effect) - weighted.dot(scaled.completeOrthogonalDecomposition().solve(weighted)));
}

}  // namespace

Experiment ProposeExperiment(const StrokeSet& recorded, std::span<const RankedEffect> rivals, double noise_variance,
                             const MachineMoves& moves, const WindowSamples& window) {
  Experiment best;
  if (rivals.size() < 2) return best;
  const ModelStructure& model = recorded.model();
  const Eigen::VectorXd theta = rivals.front().fit.theta.head(model.base_count);
  const double low = moves.pressure_min, high = moves.pressure_max, middle = 0.5 * (low + high);
  const std::vector<std::vector<double>> profiles = {{low, high}, {high, low, high}, {low, middle, high, middle, low}, {high}, {middle}, {low}};
  const std::vector<std::pair<double, double>> speeds = {{moves.speed_min, moves.speed_max},
                                                         {moves.speed_min, moves.speed_min},
                                                         {moves.speed_max, moves.speed_max}};
  std::vector<double> warm_ups = {0.0};
  if (moves.warm_up > 0) warm_ups.push_back(moves.warm_up);
  for (const auto& profile : profiles)
    for (const auto& [slow, fast] : speeds)
      for (double warm_up : warm_ups) {
        std::vector<StrokeStretches> strokes;
        for (double speed : {slow, fast})
          for (double oil : {313.15, 313.15 + warm_up})
            strokes.push_back(PlayStroke(model, theta, window, speed, profile, oil, moves.stroke));
        const auto shared = recorded.shared_model();
        Eigen::MatrixXd played = Eigen::MatrixXd::Zero(model.column_count(), model.column_count());
        for (const StrokeGram& gram : GramsOf(shared, strokes, window)) played += Unpacked(gram.integral) / 4.0;
        double nearest = std::numeric_limits<double>::infinity();
        for (const RankedEffect& a : rivals)
          for (const RankedEffect& b : rivals)
            if (a.effect != b.effect) nearest = std::min(nearest, Separation(recorded, played, a, b) / noise_variance);
        // Warming the oil takes an hour: only where it helps a good deal.
        if (nearest > best.separation * (warm_up > 0 ? 1.5 : 1.0)) {
          best.speed_low = slow;
          best.speed_high = fast;
          best.pressures = profile;
          best.warm_up = warm_up;
          best.separation = nearest;
        }
      }
  if (best.separation * kMaxStrokes < kNeeded) return Experiment{};
  best.strokes = std::clamp(static_cast<int>(std::ceil(kNeeded / best.separation)), kMinStrokes, kMaxStrokes);
  return best;
}

std::string ExperimentText(const Experiment& experiment) {
  if (experiment.pressures.empty())
    return "No series of ordinary strokes tells these effects apart; compare with the data sheet or look at the machine.";
  std::string pressures;
  for (double p : experiment.pressures) pressures += fmt::format("{}{:.0f}", pressures.empty() ? "" : " → ", p * 1e-5);
  std::string text = fmt::format("Record {} strokes, ", experiment.strokes);
  if (experiment.speed_low == experiment.speed_high)
    text += fmt::format("all at {:.0f} mm/s ram speed, ", experiment.speed_low * 1e3);
  else
    text += fmt::format("half of them at {:.0f} mm/s and half at {:.0f} mm/s ram speed, ", experiment.speed_low * 1e3,
                        experiment.speed_high * 1e3);
  text += experiment.pressures.size() == 1 ? fmt::format("at {} bar cushion pressure", pressures)
                                           : fmt::format("stepping the cushion pressure {} bar within each stroke", pressures);
  if (experiment.warm_up > 0) text += fmt::format(", the oil warming by {:.0f} K on the way", experiment.warm_up);
  return text + "; then explain again.";
}

}  // namespace hydroscope
