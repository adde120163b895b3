#include "diagnosis/experiment.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>

#include "diagnosis/played_stroke.h"
#include "diagnosis/refine.h"
#include "diagnosis/rival_separation.h"
#include "machines/die_cushion/balance.h"

namespace hydroscope {
namespace {

constexpr double kWarmUp = 3600;   ///< s of waiting that warming the oil costs
constexpr double kRodChange = 30;  ///< s that another pressure in chamber B costs, each time

/// Evidence of strokes; those played through are worked out once.
class StrokeEvidences {
 public:
  StrokeEvidences(const RivalModel& model, const Eigen::VectorXd& theta, const MachineMoves& moves,
                  const WindowSamples& window)
      : model_(model), theta_(theta), moves_(moves), window_(window) {}

  /// A stroke played through: signals without sensor noise, whose energy is that of the same stroke with
  /// noise.
  const RivalEvidence& Played(const std::vector<double>& pressures, double speed, double rod, double oil) {
    const auto [at, fresh] = played_.try_emplace({pressures, speed, rod, oil});
    if (fresh) {
      const PlayedStroke stroke{speed, rod, oil, pressures};
      at->second = Of({{Play(*model_.structure, theta_, window_, moves_, stroke)}});
      at->second.noise =
          Of({{Play(*model_.structure, theta_, window_, moves_, stroke, SensorNoise::kAsRecorded)}}).noise;
    }
    return at->second;
  }
  RivalEvidence Of(std::span<const StrokeStretches> strokes) const {
    return EvidenceOf(model_, theta_, strokes, window_);
  }

 private:
  const RivalModel& model_;
  const Eigen::VectorXd& theta_;
  const MachineMoves& moves_;
  const WindowSamples& window_;
  std::map<std::tuple<std::vector<double>, double, double, double>, RivalEvidence> played_;
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
RivalEvidence MeanStroke(const Experiment& e, const MachineMoves& moves, StrokeEvidences& strokes) {
  const std::vector<double> rods = e.rod.empty() ? std::vector{moves.rod} : e.rod;
  const std::vector<double> oils =
      e.warm_up > 0 ? std::vector{moves.oil, moves.oil + e.warm_up} : std::vector{moves.oil};
  const double share = 1.0 / static_cast<double>(rods.size() * oils.size() * e.speeds.size());
  RivalEvidence mean;
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

bool Experiment::settles() const { return separation >= kSettledSeparation; }

Experiment ProposeExperiment(const Explanation& explanation, const MachineMoves& moves,
                             std::span<const StrokeStretches> recorded, const WindowSamples& window) {
  if (explanation.verdict != Verdict::kAmbiguous || explanation.model->name != "die_cushion") return {};
  const RivalModel model = RivalModelOf(explanation);
  const Eigen::VectorXd theta = explanation.final.theta.head(model.structure->base_count);
  StrokeEvidences strokes(model, theta, moves, window);
  const RivalEvidence known = strokes.Of(recorded);
  const Rivals directions(model,
                          StrokeSet(model.structure, GramsOf(model.structure, recorded, window), window));

  Experiment best;
  for (Experiment& candidate : Candidates(moves)) {
    const RivalEvidence stroke = MeanStroke(candidate, moves, strokes);
    const auto separation = [&](int count) {
      return directions.Nearest(RivalEvidence(known).Add(stroke, count));
    };
    if (separation(moves.max_strokes) < kWorthwhileSeparation) continue;
    const int enough = StrokesToSettle(moves.max_strokes, separation);
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
