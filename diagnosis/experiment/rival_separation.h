#pragma once

#include <Eigen/Dense>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "diagnosis/explain.h"

namespace hydroscope {

/// Thresholds of proposed experiments, calibrated by `hydroscope benchmark hidden-effects --experiments`: energies are
/// between two rivals, in noise variances of an equation.
struct ExperimentOptions {
  double settled = 300.0;     ///< settles a case
  double worthwhile = 60.0;   ///< makes the longest series worth asking for: ExplainOptions::sure_gain
  double twins_apart = 1.25;  ///< times Effect::Twin::excess: noise energy by which twins must be apart
  int fewest_strokes = 24;    ///< fewer give no interval worth the name
  double watched = 0.5;       ///< share of the best effect's gain from which others must stay apart too ...
  /// ... of which the separation counts so many times, since they lag behind already.
  double watched_weight = 2.0;
};
inline constexpr ExperimentOptions kExperiment{};

/// Groups of an explanation between whose effects it cannot decide.
std::vector<std::size_t> OpenGroups(const Explanation& explanation);

/// Base columns, the effects that are not in question and the rivals in all shapes that were tried: all that
/// telling the rivals apart needs.
struct RivalModel {
  std::shared_ptr<ModelStructure> structure;
  /// Indices of effects between which the explanation cannot decide; empty if it decides.
  std::vector<int> rivals;
  /// Effects that could become rivals in strokes that do not tell them apart either.
  std::vector<int> watched;
  std::vector<EffectChoice> others;
};
/// Of one hidden effect that the explanation leaves open: `group` of OpenGroups, the first one unless said.
RivalModel RivalModelOf(const Explanation& explanation, std::size_t group);
RivalModel RivalModelOf(const Explanation& explanation);

/// What strokes say, summed: normal equations over base columns, output and the rivals' columns, the energy
/// of the sensor noise in them and the number of independent equations.
struct RivalEvidence {
  Eigen::MatrixXd total;
  double noise = 0, equations = 0;

  RivalEvidence& Add(const RivalEvidence& other, double times);
};
/// `theta`: base parameters, by which sensor noise counts.
RivalEvidence EvidenceOf(const RivalModel& model, const Eigen::VectorXd& theta, std::vector<StrokeGram> grams,
                         const WindowSamples& window);
RivalEvidence EvidenceOf(const RivalModel& model, const Eigen::VectorXd& theta,
                         std::span<const StrokeStretches> strokes, const WindowSamples& window);
/// Energy of the sensor noise in the equations of strokes, under a model of which at least base columns and output are there.
double NoiseEnergy(const Eigen::VectorXd& theta, std::span<const StrokeGram> grams);

/// The rivals as directions in the columns of their model, beside what is known to be there.
class Rivals {
 public:
  /// Shapes and sizes are those of each rival in a model with the effects not in question, on `recorded`.
  Rivals(const RivalModel& model, const StrokeSet& recorded);

  /// Two of the effects: rivals, or a rival and a watched effect.
  struct Pair {
    std::size_t a = 0, b = 0;  ///< among the rivals, and the watched effects after them
    double apart = 0;          ///< noise energy by which strokes must tell twins apart; 0: they are none
    bool watched = false;      ///< b is a watched effect
  };
  const std::vector<Pair>& pairs() const { return pairs_; }
  /// id of an effect of a pair.
  const std::string& id(std::size_t effect) const { return ids_[effect]; }

  /// Energy between the effects of each pair, in noise variances of an equation: the part of one, at its fitted size, that
  /// neither the known nor the other, at whatever sizes, can take over. That of a rival and a watched effect counts twice.
  /// Twins must be apart by Pair::apart of the noise energy, whatever the number of strokes; theirs is kExperiment.settled then.
  std::vector<double> Separations(const RivalEvidence& evidence) const;
  /// The smallest of them; 0 where the recorded strokes cannot size two rivals.
  double Nearest(const RivalEvidence& evidence) const;

 private:
  Eigen::MatrixXd known_;
  std::vector<std::string> ids_;  ///< of rivals, then of watched effects
  std::vector<Pair> pairs_;
  std::vector<Eigen::VectorXd> unit_;    ///< of rivals, then of watched effects
  std::vector<Eigen::VectorXd> fitted_;  ///< of rivals
};

/// Fewest strokes, kExperiment.fewest_strokes to `most`, that reach kExperiment.settled; `most` if none does.
/// `separation(n)` is that of n strokes and grows with n.
int StrokesToSettle(int most, const std::function<double(int)>& separation);

}  // namespace hydroscope
