#include "diagnosis/experiment.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>

#include "diagnosis/played_stroke.h"
#include "diagnosis/refine.h"
#include "models/die_cushion.h"

namespace hydroscope {
namespace {

constexpr double kNeeded = 300.0;     ///< noise variances between rivals that settle a case
constexpr double kWorthwhile = 60.0;  ///< ... and that make the longest series worth asking for
constexpr int kMinStrokes = 24;       ///< fewer give no interval worth the name
constexpr double kWarmUp = 3600;      ///< s of waiting that warming the oil costs
constexpr double kRodChange = 30;     ///< s that another pressure in chamber B costs, each time

/// Effects between which the explanation cannot decide, of the first that it leaves open.
std::vector<int> RivalsOf(const Explanation& explanation) {
  std::vector<int> rivals;
  const auto& effects = explanation.model->effects;
  for (const auto& group : explanation.groups) {
    if (group.size() < 2) continue;
    for (const std::string& id : group)
      for (std::size_t e = 0; e < effects.size(); ++e)
        if (effects[e]->id == id) rivals.push_back(static_cast<int>(e));
    break;
  }
  return rivals;
}

/// Base columns, the effects that are not in question and the rivals in all shapes that were tried: all that
/// playing through needs.
struct PlayedModel {
  std::shared_ptr<ModelStructure> structure;
  std::vector<int> rivals;  ///< indices of effects
  std::vector<EffectChoice> others;
};

PlayedModel ModelOf(const Explanation& explanation) {
  PlayedModel out{std::make_shared<ModelStructure>(*explanation.model), RivalsOf(explanation), {}};
  ModelStructure& structure = *out.structure;
  structure.columns.resize(structure.output_column() + 1);
  for (auto& shapes : structure.effect_shapes) shapes.clear();
  for (const int rival : out.rivals)
    for (const EffectShape& shape : explanation.model->effect_shapes[rival])
      AddShape(structure, rival, shape.nonlinear);
  for (const EffectChoice& choice : explanation.chosen) {
    if (std::find(out.rivals.begin(), out.rivals.end(), choice.effect) != out.rivals.end()) continue;
    AddShape(structure, choice.effect,
             explanation.model->effect_shapes[choice.effect][choice.shape].nonlinear);
    out.others.push_back({choice.effect, 0});
  }
  return out;
}

/// Energy of `a` in `total` that `known`, one column each, and `b`, at whatever sizes, cannot take over.
double Separation(const Eigen::MatrixXd& total, const Eigen::VectorXd& a, const Eigen::MatrixXd& known,
                  const Eigen::VectorXd& b) {
  Eigen::MatrixXd regressors(known.rows(), known.cols() + 1);
  regressors << known, b;
  const Eigen::MatrixXd weighed = total * regressors;
  const Eigen::MatrixXd h = regressors.transpose() * weighed;
  const Eigen::VectorXd scale = h.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = scale.asDiagonal() * h * scale.asDiagonal();
  const Eigen::VectorXd cross = scale.asDiagonal() * (weighed.transpose() * a);
  return std::max(0.0, a.dot(total * a) - cross.dot(scaled.completeOrthogonalDecomposition().solve(cross)));
}

/// What strokes say, summed: normal equations over base columns, output and the rivals' columns, the energy
/// of the sensor noise in them and the number of independent equations.
struct Evidence {
  Eigen::MatrixXd total;
  double noise = 0, equations = 0;

  Evidence& Add(const Evidence& other, double times) {
    total = total.size() == 0 ? Eigen::MatrixXd(times * other.total)
                              : Eigen::MatrixXd(total + times * other.total);
    noise += times * other.noise;
    equations += times * other.equations;
    return *this;
  }
};

/// Evidence of strokes; those played through are worked out once.
class StrokeEvidences {
 public:
  StrokeEvidences(const PlayedModel& model, const Eigen::VectorXd& theta, const MachineMoves& moves,
                  const WindowSamples& window)
      : model_(model), theta_(theta), moves_(moves), window_(window) {}

  /// A stroke played through: signals without sensor noise, whose energy is that of the same stroke with
  /// noise.
  const Evidence& Played(const std::vector<double>& pressures, double speed, double rod, double oil) {
    const auto [at, fresh] = played_.try_emplace({pressures, speed, rod, oil});
    if (fresh) {
      const PlayedStroke stroke{speed, rod, oil, pressures};
      at->second = Of({{Play(*model_.structure, theta_, window_, moves_, stroke)}});
      at->second.noise =
          Of({{Play(*model_.structure, theta_, window_, moves_, stroke, SensorNoise::kAsRecorded)}}).noise;
    }
    return at->second;
  }
  Evidence Of(std::span<const StrokeStretches> strokes) const {
    const std::vector<StrokeGram> grams = GramsOf(model_.structure, strokes, window_);
    Evidence out{StrokeSet(model_.structure, grams, window_).Total(), 0, 0};
    Eigen::VectorXd balance(theta_.size() + 1);
    balance << -theta_, 1;
    for (const StrokeGram& gram : grams) {
      const Eigen::MatrixXd noise = Unpacked(gram.noise).topLeftCorner(balance.size(), balance.size());
      out.noise += balance.dot(noise * balance);
      out.equations += static_cast<double>(gram.blocks - gram.spans);
    }
    return out;
  }

 private:
  const PlayedModel& model_;
  const Eigen::VectorXd& theta_;
  const MachineMoves& moves_;
  const WindowSamples& window_;
  std::map<std::tuple<std::vector<double>, double, double, double>, Evidence> played_;
};

/// The rivals as directions in the columns of the played model, beside what is known to be there.
class Rivals {
 public:
  /// Shapes and sizes are those of each rival in a model with the effects not in question, on `recorded`.
  Rivals(const PlayedModel& model, const StrokeSet& recorded) {
    const int base = model.structure->base_count;
    const auto others = static_cast<Eigen::Index>(model.others.size());
    known_ = Eigen::MatrixXd::Identity(model.structure->column_count(), base + others);
    for (const int rival : model.rivals) {
      std::vector<EffectChoice> choices = model.others;
      choices.push_back(recorded.BestShape(rival, model.others));
      if (choices.back().shape < 0) continue;
      const ExtendedFit fit = recorded.Fit(choices);
      const auto direction = [&](std::size_t k) {
        Eigen::VectorXd at(base + 1);
        at << fit.theta.head(base), fit.effects[k].size;
        return recorded.Direction(choices[k], at);
      };
      for (std::size_t k = 0; k < model.others.size(); ++k)
        known_.col(base + static_cast<Eigen::Index>(k)) = direction(k);
      unit_.push_back(direction(model.others.size()));
      fitted_.push_back(unit_.back() * fit.effects.back().size);
    }
  }

  /// Energy between the two that are nearest to one another, in noise variances of an equation; 0 where the
  /// recorded strokes cannot size two of them.
  double Nearest(const Evidence& evidence) const {
    if (unit_.size() < 2) return 0;
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t a = 0; a < fitted_.size(); ++a)
      for (std::size_t b = 0; b < unit_.size(); ++b)
        if (a != b) nearest = std::min(nearest, Separation(evidence.total, fitted_[a], known_, unit_[b]));
    return nearest * evidence.equations / evidence.noise;
  }

 private:
  Eigen::MatrixXd known_;
  std::vector<Eigen::VectorXd> unit_, fitted_;
};

std::vector<std::vector<double>> PressureProfiles(const MachineMoves& moves) {
  const double low = moves.pressure_min, high = moves.pressure_max;
  const auto at = [&](double share) { return low + share * (high - low); };
  return {{low, high},
          {high, low, high},
          {low, high, low, high},
          {low, high, low, high, low, high, low, high},
          {low, at(0.5), high, at(0.5), low},
          {low, at(0.1), at(0.3), at(0.6), high},
          {low, at(0.2), low, at(0.2), low, at(0.5)},
          {low, high, high},
          {high},
          {at(0.5)},
          {low}};
}

std::vector<std::vector<double>> SpeedSeries(const MachineMoves& moves) {
  const double slow = moves.speed_min, fast = moves.speed_max, middle = 0.5 * (slow + fast);
  return {{slow, fast}, {slow, middle, fast}, {slow}, {middle}, {fast}};
}

std::vector<std::vector<double>> RodSeries(const MachineMoves& moves) {
  if (moves.rod_max <= moves.rod_min) return {{}};
  return {{}, {moves.rod_min, moves.rod_max}};
}

/// Every series of the moves allowed, its number of strokes left open.
std::vector<Experiment> Candidates(const MachineMoves& moves) {
  std::vector<Experiment> out;
  for (const auto& pressures : PressureProfiles(moves))
    for (const auto& speeds : SpeedSeries(moves))
      for (const auto& rod : RodSeries(moves))
        for (const double warm_up : moves.warm_up > 0 ? std::vector{0.0, moves.warm_up} : std::vector{0.0})
          out.push_back({.speeds = speeds, .pressures = pressures, .rod = rod, .warm_up = warm_up});
  return out;
}

/// Mean stroke of a candidate.
Evidence MeanStroke(const Experiment& e, const MachineMoves& moves, StrokeEvidences& strokes) {
  const std::vector<double> rods = e.rod.empty() ? std::vector{moves.rod} : e.rod;
  const std::vector<double> oils =
      e.warm_up > 0 ? std::vector{moves.oil, moves.oil + e.warm_up} : std::vector{moves.oil};
  const double share = 1.0 / static_cast<double>(rods.size() * oils.size() * e.speeds.size());
  Evidence mean;
  for (const double rod : rods)
    for (const double oil : oils)
      for (const double speed : e.speeds) mean.Add(strokes.Played(e.pressures, speed, rod, oil), share);
  return mean;
}

/// s of drawing and waiting.
double Price(const Experiment& e) {
  return e.seconds + (e.warm_up > 0 ? kWarmUp : 0) + kRodChange * static_cast<double>(e.rod.size());
}

/// Whether `a` is the better series: it settles the case sooner, or goes further where none settles it.
bool Better(const Experiment& a, const Experiment& b) {
  if (a.settles() != b.settles()) return a.settles();
  return a.settles() ? Price(a) < Price(b) : a.separation > b.separation;
}

}  // namespace

bool Experiment::settles() const { return separation >= kNeeded; }

Experiment ProposeExperiment(const Explanation& explanation, const MachineMoves& moves,
                             std::span<const StrokeStretches> recorded, const WindowSamples& window) {
  if (explanation.verdict != Verdict::kAmbiguous || explanation.model->name != "die_cushion") return {};
  const PlayedModel model = ModelOf(explanation);
  const Eigen::VectorXd theta = explanation.final.theta.head(model.structure->base_count);
  StrokeEvidences strokes(model, theta, moves, window);
  const Evidence known = strokes.Of(recorded);
  const Rivals directions(model,
                          StrokeSet(model.structure, GramsOf(model.structure, recorded, window), window));

  Experiment best;
  for (Experiment& candidate : Candidates(moves)) {
    const Evidence stroke = MeanStroke(candidate, moves, strokes);
    const auto separation = [&](int count) { return directions.Nearest(Evidence(known).Add(stroke, count)); };
    int enough = moves.max_strokes;
    const double most = separation(enough);
    if (most < kWorthwhile) continue;
    for (int few = kMinStrokes - 1; most >= kNeeded && enough - few > 1;) {
      const int middle = (few + enough) / 2;
      (separation(middle) < kNeeded ? few : enough) = middle;
    }
    candidate.strokes = enough;
    candidate.separation = separation(enough);
    for (const double speed : candidate.speeds)
      candidate.seconds += enough * moves.stroke / speed / static_cast<double>(candidate.speeds.size());
    if (best.pressures.empty() || Better(candidate, best)) best = candidate;
  }
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
  if (!experiment.rod.empty())
    text += fmt::format(", with {} bar in chamber B, changed after each round of speeds",
                        list(experiment.rod, 1e-5, " and "));
  if (experiment.warm_up > 0)
    text += fmt::format(", the oil warming by {:.0f} K on the way", experiment.warm_up);
  return text +
         fmt::format(" ({:.0f} s of drawing); then explain this log and that one together.{}",
                     experiment.seconds,
                     experiment.settles() ? "" : " It may not be enough: the effects are small and alike.");
}

}  // namespace hydroscope
