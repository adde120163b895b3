#include "diagnosis/experiment/experiment.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>

#include "core/contains.h"
#include "diagnosis/experiment/rival_separation.h"
#include "diagnosis/sample_grams.h"

namespace hydroscope {
namespace {

/// Evidence of strokes; those played through are worked out once.
class StrokeEvidences {
 public:
  StrokeEvidences(const RivalModel& model, const Eigen::VectorXd& theta, const Experimenter& experimenter,
                  const WindowSamples& window)
      : model_(model),
        base_(std::make_shared<ModelStructure>(BaseOnly(*model.structure))),
        theta_(theta),
        experimenter_(experimenter),
        window_(window) {}

  /// Mean stroke of a series that begins at `begin`, s.
  RivalEvidence MeanOf(const StrokeSeries& series, double begin) {
    const std::vector<UnrecordedStroke> strokes =
        experimenter_.StrokesOf(series, begin, kExperiment.fewest_strokes);
    const double share = 1.0 / static_cast<double>(strokes.size());
    RivalEvidence mean;
    for (const UnrecordedStroke& stroke : strokes) mean.Add(OfUnrecorded(stroke), share);
    return mean;
  }

 private:
  /// Signals without sensor noise, whose energy is that of the same stroke with noise.
  const RivalEvidence& OfUnrecorded(const UnrecordedStroke& stroke) {
    const auto [at, fresh] = played_.try_emplace(stroke);
    if (fresh) {
      at->second = EvidenceOf(model_, theta_, {{Play(stroke, PlayedNoise::kNone)}}, window_);
      at->second.noise =
          NoiseEnergy(theta_, GramsOf(base_, {{Play(stroke, PlayedNoise::kAsRecorded)}}, window_));
    }
    return at->second;
  }
  StrokeStretches Play(const UnrecordedStroke& stroke, PlayedNoise noise) const {
    const StrokeSampling sampling{window_.period, window_.span * window_.block};
    return experimenter_.Play(*model_.structure, theta_, stroke, sampling, noise);
  }

  const RivalModel& model_;
  std::shared_ptr<const ModelStructure> base_;
  const Eigen::VectorXd& theta_;
  const Experimenter& experimenter_;
  const WindowSamples& window_;
  std::map<UnrecordedStroke, RivalEvidence> played_;
};

/// One hidden effect that the explanation leaves open: what series of strokes say of its rivals.
class OpenQuestion {
 public:
  OpenQuestion(const Explanation& explanation, std::size_t group, const Experimenter& experimenter,
               int max_strokes, std::span<const StrokeStretches> recorded, const WindowSamples& window)
      : model_(RivalModelOf(explanation, group)),
        theta_(explanation.final.theta.head(model_.structure->base_count)),
        max_strokes_(max_strokes),
        strokes_(model_, theta_, experimenter, window),
        recorded_(GramsOf(model_.structure, recorded, window)),
        known_(EvidenceOf(model_, theta_, recorded_, window)),
        rivals_(model_, StrokeSet(model_.structure, recorded_, window)) {
    for (const StrokeStretches& stroke : recorded)
      for (const Stretch& s : stroke) begin_ = std::max(begin_, s.begin + s.samples * s.period);
  }
  OpenQuestion(const OpenQuestion&) = delete;

  /// Takes up a candidate: of its strokes those pairs count that the longest series of them tells apart. More strokes do
  /// not help twins: theirs must settle it.
  void Take(const StrokeSeries& candidate) {
    means_.push_back(strokes_.MeanOf(candidate, begin_));
    const std::vector<double> most = After(means_.size() - 1, max_strokes_);
    told_.emplace_back();
    for (std::size_t p = 0; p < most.size(); ++p)
      told_.back().push_back(most[p] >=
                             (rivals_.pairs()[p].apart > 0 ? kExperiment.settled : kExperiment.worthwhile));
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
      if (!told_[candidate][p] && !pair.watched && !Contains(ids, id)) ids.push_back(id);
    }
  }

 private:
  std::vector<double> After(std::size_t candidate, int strokes) const {
    return rivals_.Separations(RivalEvidence(known_).Add(means_[candidate], strokes));
  }

  RivalModel model_;
  Eigen::VectorXd theta_;
  int max_strokes_;
  StrokeEvidences strokes_;
  std::vector<StrokeGram> recorded_;
  RivalEvidence known_;
  Rivals rivals_;
  std::vector<RivalEvidence> means_;     ///< of a mean stroke of each candidate
  std::vector<std::vector<bool>> told_;  ///< of each candidate, per pair
  double begin_ = 0;                     ///< s, at which strokes to be recorded begin
};

}  // namespace

bool Experiment::settles() const { return separation >= kExperiment.settled; }

const std::vector<double>& Experiment::Levels(std::string_view setting) const {
  static const std::vector<double> kAsRecorded;
  for (std::size_t k = 0; k < levels.size(); ++k)
    if (kind->experiment.settings[k].key == setting) return levels[k];
  return kAsRecorded;
}

Experiment ProposeExperiment(const Explanation& explanation, const Machine& machine,
                             std::span<const StrokeStretches> recorded, const WindowSamples& window) {
  const MachineKind* kind = explanation.model->kind;
  if (explanation.verdict != Verdict::kAmbiguous || kind->experiment.on == nullptr) return {};
  const std::unique_ptr<Experimenter> experimenter = kind->experiment.on(machine, recorded);
  const int max_strokes = machine.experiment.max_strokes;
  const std::vector<StrokeSeries> candidates = experimenter->Candidates();
  std::vector<std::unique_ptr<OpenQuestion>> questions;
  for (const std::size_t group : OpenGroups(explanation)) {
    questions.push_back(
        std::make_unique<OpenQuestion>(explanation, group, *experimenter, max_strokes, recorded, window));
    for (const StrokeSeries& candidate : candidates) questions.back()->Take(candidate);
  }
  const auto told = [&](std::size_t candidate) {
    int sum = 0;
    for (const auto& question : questions) sum += question->Told(candidate);
    return sum;
  };
  int most = 0;
  for (std::size_t k = 0; k < candidates.size(); ++k) most = std::max(most, told(k));

  // The better series settles the case sooner, or goes further where none settles it.
  const auto better = [&](const Experiment& a, const Experiment& b) {
    if (a.settles() != b.settles()) return a.settles();
    return a.settles() ? experimenter->Price(a.levels, a.seconds) < experimenter->Price(b.levels, b.seconds)
                       : a.separation > b.separation;
  };
  Experiment best;
  for (std::size_t k = 0; k < candidates.size() && most > 0; ++k) {
    if (told(k) < most) continue;
    const auto separation = [&](int count) {
      double nearest = std::numeric_limits<double>::infinity();
      for (const auto& question : questions) nearest = std::min(nearest, question->Nearest(k, count));
      return nearest;
    };
    Experiment candidate{.kind = kind, .levels = candidates[k]};
    candidate.strokes = StrokesToSettle(max_strokes, separation);
    candidate.separation = separation(candidate.strokes);
    candidate.seconds = experimenter->Seconds(candidate.levels, candidate.strokes);
    for (const auto& question : questions) question->AddLeft(k, candidate.left);
    if (!best.proposed() || better(candidate, best)) best = std::move(candidate);
  }
  if (!best.proposed())
    for (const std::size_t group : OpenGroups(explanation))
      best.left.insert(best.left.end(), explanation.groups[group].begin(), explanation.groups[group].end());
  return best;
}

Told ExperimentText(const Experiment& experiment) {
  return Tell("{}; then explain this log and that one together.{}",
              "{}; dann diese und jene Aufzeichnung zusammen erklären lassen.{}",
              experiment.kind->experiment.text(experiment.levels, experiment.strokes, experiment.seconds),
              experiment.settles()
                  ? Told{}
                  : Tell(" It may not be enough: the effects are small and alike.",
                         " Vielleicht reicht es nicht: die Effekte sind klein und einander ähnlich."));
}

}  // namespace hydroscope
