#include "diagnosis/experiment.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "core/quantile.h"
#include "estimation/stroke_accumulator.h"
#include "models/die_cushion.h"

namespace hydroscope {
namespace {

constexpr double kNeeded = 200.0;       ///< noise variances between rivals that settle a case
constexpr int kMinStrokes = 12;         ///< fewer give no interval worth the name
constexpr double kStepTime = 0.05;      ///< s, time constant of a pressure step
constexpr double kRodPressure = 60e5;   ///< Pa, rod side of the strokes played through
constexpr double kSupply = 210e5;       ///< Pa
constexpr double kColdOil = 308.15;     ///< K, of the first stroke
constexpr double kUsableOpening = 0.8;  ///< pressures are raised so that less is enough
constexpr double kWarmUpPrice =
    1.5;  ///< warming the oil takes an hour: only where it separates so much better

/// Base columns and one shape per rival: all that playing through needs.
struct PlayedModel {
  std::shared_ptr<ModelStructure> structure;
  std::vector<EffectChoice> rivals;
};

PlayedModel ModelOf(const Explanation& explanation, const std::vector<RankedEffect>& rivals) {
  PlayedModel out{std::make_shared<ModelStructure>(*explanation.model), {}};
  out.structure->columns.resize(out.structure->output_column() + 1);
  for (auto& shapes : out.structure->effect_shapes) shapes.clear();
  for (const RankedEffect& rival : rivals) {
    AddShape(*out.structure, rival.effect, rival.nonlinear);
    out.rivals.push_back(
        {rival.effect, static_cast<int>(out.structure->effect_shapes[rival.effect].size()) - 1});
  }
  return out;
}

/// One stroke of a series.
struct PlayedStroke {
  double speed, oil;
  const std::vector<double>& pressures;
};

/// Plays one stroke through: pressures in equal parts of the stroke, the spool where the base balance wants
/// it. Spans in which the gate would shut are left out.
StrokeStretches Play(const ModelStructure& model, const Eigen::VectorXd& theta, const WindowSamples& window,
                     const MachineMoves& moves, const PlayedStroke& played) {
  const double period = window.period;
  const int samples = static_cast<int>(moves.stroke / played.speed / period),
            span = window.span * window.block;
  const double least = std::pow(model.piston_area * played.speed / (kUsableOpening * std::abs(theta[0])), 2);
  StrokeStretches out;
  double p = std::max(least, played.pressures.front());
  for (int first = 0; first + span <= samples; first += span) {
    Stretch stretch;
    stretch.period = period;
    stretch.samples = span;
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
      stretch.channel[kPressureA][k] = p;
      stretch.channel[kPosition][k] = z;
      stretch.channel[kSpool][k] = y;
      stretch.channel[kPressureB][k] = kRodPressure;
      stretch.channel[kSupplyPressure][k] = kSupply;
      stretch.channel[kOilTemperature][k] = played.oil;
    }
    if (open) out.push_back(std::move(stretch));
  }
  return out;
}

/// Energy of rival `a` at its fitted size in `played` that the base columns and rival `b`, at whatever size,
/// cannot take over.
double Separation(const Eigen::MatrixXd& played, const Eigen::VectorXd& a, const Eigen::VectorXd& b,
                  int base) {
  Eigen::MatrixXd regressors = Eigen::MatrixXd::Zero(played.rows(), base + 1);
  regressors.topLeftCorner(base, base).setIdentity();
  regressors.col(base) = b;
  const Eigen::MatrixXd h = regressors.transpose() * played * regressors;
  const Eigen::VectorXd cross = regressors.transpose() * played * a;
  const Eigen::VectorXd scale = h.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = scale.asDiagonal() * h * scale.asDiagonal();
  const Eigen::VectorXd weighted = scale.asDiagonal() * cross;
  return std::max(0.0,
                  a.dot(played * a) - weighted.dot(scaled.completeOrthogonalDecomposition().solve(weighted)));
}

std::vector<std::vector<double>> PressureProfiles(const MachineMoves& moves) {
  const double low = moves.pressure_min, high = moves.pressure_max, middle = 0.5 * (low + high);
  return {{low, high},
          {high, low, high},
          {low, high, low, high},
          {low, middle, high, middle, low},
          {high},
          {middle},
          {low}};
}

std::vector<std::vector<double>> SpeedSeries(const MachineMoves& moves) {
  const double slow = moves.speed_min, fast = moves.speed_max, middle = 0.5 * (slow + fast);
  return {{slow, fast}, {slow, middle, fast}, {slow}, {middle}, {fast}};
}

}  // namespace

MachineMoves MovesOf(const Machine& machine, std::span<const StrokeStretches> strokes) {
  std::vector<double> speeds, pressures;
  double top = 0, bottom = std::numeric_limits<double>::infinity();
  for (const StrokeStretches& stroke : strokes)
    for (const Stretch& stretch : stroke) {
      const auto &z = stretch.channel[kPosition], &p = stretch.channel[kPressureA];
      speeds.push_back((z[0] - z[stretch.samples - 1]) / ((stretch.samples - 1) * stretch.period));
      pressures.insert(pressures.end(), p.begin(), p.begin() + stretch.samples);
      top = std::max(top, z[0]);
      bottom = std::min(bottom, z[stretch.samples - 1]);
    }
  MachineMoves moves;
  const ExperimentSpec& spec = machine.experiment;
  moves.speed_min = spec.speed_min.value_or(std::max(1e-3, Quantile(speeds, 0.05, 0)));
  moves.speed_max = std::max(moves.speed_min, spec.speed_max.value_or(Quantile(speeds, 0.95, 0)));
  moves.pressure_min = spec.pressure_min.value_or(std::max(5e5, Quantile(pressures, 0.05, 0)));
  moves.pressure_max = std::max(moves.pressure_min, spec.pressure_max.value_or(Quantile(pressures, 0.95, 0)));
  moves.stroke = std::max(0.01, top - bottom);
  moves.warm_up = spec.warm_up;
  moves.max_strokes = spec.max_strokes;
  for (const GateBound& bound : machine.gate.bounds)
    if (bound.signal == "y_v" && !bound.rate && bound.min)
      moves.min_opening = std::max(moves.min_opening, *bound.min);
  return moves;
}

std::vector<RankedEffect> RivalsOf(const Explanation& explanation) {
  std::vector<RankedEffect> rivals;
  for (const auto& group : explanation.groups) {
    if (group.size() < 2) continue;
    for (const std::string& id : group)
      for (const auto* ranking : {&explanation.second, &explanation.ranking}) {
        const auto at = std::find_if(ranking->begin(), ranking->end(),
                                     [&](const RankedEffect& r) { return r.id == id && r.fit.solved; });
        if (at == ranking->end()) continue;
        rivals.push_back(*at);
        break;
      }
    break;
  }
  return rivals;
}

Experiment ProposeExperiment(const Explanation& explanation, const MachineMoves& moves,
                             const WindowSamples& window) {
  Experiment best;
  const std::vector<RankedEffect> rivals = RivalsOf(explanation);
  if (rivals.size() < 2 || explanation.model->name != "die_cushion") return best;
  const PlayedModel model = ModelOf(explanation, rivals);
  const int base = model.structure->base_count;
  const Eigen::VectorXd theta = explanation.final.theta.head(base);
  const auto gram_of = [&](const PlayedStroke& played) {
    const std::vector<StrokeStretches> stroke = {Play(*model.structure, theta, window, moves, played)};
    return GramsOf(model.structure, stroke, window);
  };
  for (const auto& pressures : PressureProfiles(moves)) {
    std::map<std::pair<double, double>, StrokeSet> played;  // by speed and oil temperature
    const auto set_of = [&](double speed, double oil) -> const StrokeSet& {
      const auto at = played.find({speed, oil});
      if (at != played.end()) return at->second;
      return played
          .emplace(std::pair(speed, oil),
                   StrokeSet(model.structure, gram_of({speed, oil, pressures}), window))
          .first->second;
    };
    for (const auto& speeds : SpeedSeries(moves))
      for (double warm_up : moves.warm_up > 0 ? std::vector{0.0, moves.warm_up} : std::vector{0.0}) {
        Eigen::MatrixXd total =
            Eigen::MatrixXd::Zero(model.structure->column_count(), model.structure->column_count());
        for (double speed : speeds)
          for (double oil : {kColdOil, kColdOil + warm_up})
            total += set_of(speed, oil).Total() / (2.0 * static_cast<double>(speeds.size()));
        const StrokeSet& any = set_of(speeds.front(), kColdOil);
        double nearest = std::numeric_limits<double>::infinity();
        for (std::size_t a = 0; a < rivals.size(); ++a)
          for (std::size_t b = 0; b < rivals.size(); ++b) {
            if (a == b) continue;
            const auto direction = [&](std::size_t r) {
              Eigen::VectorXd at(base + 1);
              at << rivals[r].fit.theta.head(base), rivals[r].fit.effects.back().size;
              return any.Direction(model.rivals[r], at);
            };
            const Eigen::VectorXd effect = direction(a) * rivals[a].fit.effects.back().size;
            nearest = std::min(
                nearest, Separation(total, effect, direction(b), base) / explanation.base.noise_variance);
          }
        if (nearest <= best.separation * (warm_up > 0 ? kWarmUpPrice : 1.0)) continue;
        best = {speeds, pressures, warm_up, 0, nearest, 0};
      }
  }
  if (best.separation * moves.max_strokes < kNeeded) return Experiment{};
  best.strokes = std::max(kMinStrokes, static_cast<int>(std::ceil(kNeeded / best.separation)));
  for (double speed : best.speeds)
    best.seconds += best.strokes * moves.stroke / speed / static_cast<double>(best.speeds.size());
  return best;
}

std::string ExperimentText(const Experiment& experiment) {
  const auto list = [](const std::vector<double>& values, double factor, const char* between) {
    std::string text;
    for (double v : values) text += fmt::format("{}{:.0f}", text.empty() ? "" : between, v * factor);
    return text;
  };
  std::string text = fmt::format("Record {} strokes at {} mm/s ram speed", experiment.strokes,
                                 list(experiment.speeds, 1e3, ", "));
  if (experiment.speeds.size() > 1) text += " in turn";
  text += experiment.pressures.size() == 1
              ? fmt::format(", holding {} bar cushion pressure", list(experiment.pressures, 1e-5, ""))
              : fmt::format(", stepping the cushion pressure {} bar within each stroke",
                            list(experiment.pressures, 1e-5, " -> "));
  if (experiment.warm_up > 0)
    text += fmt::format(", the oil warming by {:.0f} K on the way", experiment.warm_up);
  return text + fmt::format(" ({:.0f} s of drawing); then explain that log.", experiment.seconds);
}

}  // namespace hydroscope
