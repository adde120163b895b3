#include "diagnosis/experiment/experiment.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <tuple>

#include "diagnosis/experiment/played_stroke.h"
#include "diagnosis/experiment/rival_separation.h"
#include "diagnosis/refine.h"
#include "machines/die_cushion/balance.h"

namespace hydroscope {
namespace {

/// Evidence of strokes; those played through are worked out once.
class StrokeEvidences {
 public:
  StrokeEvidences(const RivalModel& model, const Eigen::VectorXd& theta, const MachineMoves& moves,
                  const WindowSamples& window)
      : model_(model), theta_(theta), moves_(moves), window_(window) {}

  /// A stroke played through: signals without sensor noise, whose energy is that of the same stroke with noise.
  const RivalEvidence& Played(const std::vector<double>& pressures, double speed, double rod, double oil,
                              double begin) {
    const auto [at, fresh] = played_.try_emplace({pressures, speed, rod, oil, begin});
    if (fresh) {
      const PlayedStroke stroke{speed, rod, oil, begin, pressures};
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
  std::map<std::tuple<std::vector<double>, double, double, double, double>, RivalEvidence> played_;
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

/// s, that a series takes which is no longer than it must be, at a middling speed, upwards as downwards.
double ShortestSeries(const MachineMoves& moves) {
  return kExperiment.fewest_strokes * 2 * moves.stroke / (0.5 * (moves.speed_min + moves.speed_max));
}

/// Mean stroke of a candidate, of a series that begins at `begin`, s: what drifts goes on.
RivalEvidence MeanStroke(const Experiment& e, const MachineMoves& moves, double begin,
                         StrokeEvidences& strokes) {
  const std::vector<double> rods = e.rod.empty() ? std::vector{moves.rod} : e.rod;
  const double end = begin + ShortestSeries(moves);
  const double share = 1.0 / static_cast<double>(2 * rods.size() * e.speeds.size());
  RivalEvidence mean;
  for (const double rod : rods)
    for (const double speed : e.speeds) {
      mean.Add(strokes.Played(e.pressures, speed, rod, moves.oil, begin), share);
      mean.Add(strokes.Played(e.pressures, speed, rod, moves.oil + e.warm_up, end), share);
    }
  return mean;
}

/// s of drawing and waiting.
double Price(const Experiment& e) {
  return e.seconds + (e.warm_up > 0 ? kExperiment.warm_up : 0) +
         kExperiment.rod_change * static_cast<double>(e.rod.size());
}

/// Whether `a` is the better series: it settles the case sooner, or goes further where none settles it.
bool Better(const Experiment& a, const Experiment& b) {
  if (a.settles() != b.settles()) return a.settles();
  return a.settles() ? Price(a) < Price(b) : a.separation > b.separation;
}

/// One hidden effect that the explanation leaves open: what series of strokes say of its rivals.
class OpenQuestion {
 public:
  OpenQuestion(const Explanation& explanation, std::size_t group, const MachineMoves& moves,
               std::span<const StrokeStretches> recorded, const WindowSamples& window)
      : model_(RivalModelOf(explanation, group)),
        theta_(explanation.final.theta.head(model_.structure->base_count)),
        moves_(moves),
        strokes_(model_, theta_, moves, window),
        known_(strokes_.Of(recorded)),
        rivals_(model_, StrokeSet(model_.structure, GramsOf(model_.structure, recorded, window), window)) {
    for (const StrokeStretches& stroke : recorded)
      for (const Stretch& s : stroke) begin_ = std::max(begin_, s.begin + s.samples * s.period);
  }
  OpenQuestion(const OpenQuestion&) = delete;

  /// Takes up a candidate: of its strokes those pairs count that the longest series of them tells apart. More strokes do
  /// not help twins: theirs must settle it.
  void Take(const Experiment& candidate) {
    means_.push_back(MeanStroke(candidate, moves_, begin_, strokes_));
    const std::vector<double> most = After(means_.size() - 1, moves_.max_strokes);
    told_.emplace_back();
    for (std::size_t p = 0; p < most.size(); ++p)
      told_.back().push_back(most[p] >=
                             (rivals_.pairs()[p].twins ? kExperiment.settled : kExperiment.worthwhile));
  }
  /// Pairs of rivals that strokes of candidate number `candidate` tell apart.
  int Told(std::size_t candidate) const {
    int told = 0;
    for (std::size_t p = 0; p < rivals_.pairs().size(); ++p)
      told += told_[candidate][p] && !rivals_.pairs()[p].watched;
    return told;
  }
  /// Between the nearest two that it tells apart, watched effects among them, after `strokes`.
  double Nearest(std::size_t candidate, int strokes) const {
    const std::vector<double> all = After(candidate, strokes);
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t p = 0; p < all.size(); ++p)
      if (told_[candidate][p]) nearest = std::min(nearest, all[p]);
    return nearest;
  }
  /// Rivals that the candidate does not tell from another one.
  void AddLeft(std::size_t candidate, std::vector<std::string>& ids) const {
    for (std::size_t p = 0; p < rivals_.pairs().size(); ++p) {
      const Rivals::Pair& pair = rivals_.pairs()[p];
      const std::string& id = rivals_.id(pair.a);
      if (!told_[candidate][p] && !pair.watched && std::find(ids.begin(), ids.end(), id) == ids.end())
        ids.push_back(id);
    }
  }

 private:
  std::vector<double> After(std::size_t candidate, int strokes) const {
    return rivals_.Separations(RivalEvidence(known_).Add(means_[candidate], strokes));
  }

  RivalModel model_;
  Eigen::VectorXd theta_;
  const MachineMoves& moves_;
  StrokeEvidences strokes_;
  RivalEvidence known_;
  Rivals rivals_;
  std::vector<RivalEvidence> means_;     ///< of a mean stroke of each candidate
  std::vector<std::vector<bool>> told_;  ///< of each candidate, per pair
  double begin_ = 0;                     ///< s, at which strokes to be recorded begin
};

}  // namespace

bool Experiment::settles() const { return separation >= kExperiment.settled; }

Experiment ProposeExperiment(const Explanation& explanation, const MachineMoves& moves,
                             std::span<const StrokeStretches> recorded, const WindowSamples& window) {
  if (explanation.verdict != Verdict::kAmbiguous || explanation.model->name != "die_cushion") return {};
  const std::vector<Experiment> candidates = Candidates(moves);
  std::vector<std::unique_ptr<OpenQuestion>> questions;
  for (const std::size_t group : OpenGroups(explanation)) {
    questions.push_back(std::make_unique<OpenQuestion>(explanation, group, moves, recorded, window));
    for (const Experiment& candidate : candidates) questions.back()->Take(candidate);
  }
  const auto told = [&](std::size_t candidate) {
    int sum = 0;
    for (const auto& question : questions) sum += question->Told(candidate);
    return sum;
  };
  int most = 0;
  for (std::size_t k = 0; k < candidates.size(); ++k) most = std::max(most, told(k));

  Experiment best;
  for (std::size_t k = 0; k < candidates.size() && most > 0; ++k) {
    if (told(k) < most) continue;
    const auto separation = [&](int count) {
      double nearest = std::numeric_limits<double>::infinity();
      for (const auto& question : questions) nearest = std::min(nearest, question->Nearest(k, count));
      return nearest;
    };
    Experiment candidate = candidates[k];
    candidate.strokes = StrokesToSettle(moves.max_strokes, separation);
    candidate.separation = separation(candidate.strokes);
    for (const double speed : candidate.speeds)
      candidate.seconds +=
          candidate.strokes * moves.stroke / speed / static_cast<double>(candidate.speeds.size());
    for (const auto& question : questions) question->AddLeft(k, candidate.left);
    if (best.pressures.empty() || Better(candidate, best)) best = std::move(candidate);
  }
  if (best.pressures.empty())
    for (const std::size_t group : OpenGroups(explanation))
      best.left.insert(best.left.end(), explanation.groups[group].begin(), explanation.groups[group].end());
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
