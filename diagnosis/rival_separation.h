#pragma once

#include <Eigen/Dense>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "diagnosis/explain.h"

namespace hydroscope {

/// What strokes to be recorded must reach between the two nearest rivals, in noise variances of an equation.
inline constexpr double kSettledSeparation = 300.0;    ///< settles a case
inline constexpr double kWorthwhileSeparation = 60.0;  ///< makes the longest series worth asking for
inline constexpr int kFewestProposed = 24;             ///< strokes: fewer give no interval worth the name

/// Base columns, the effects that are not in question and the rivals in all shapes that were tried: all that
/// telling the rivals apart needs.
struct RivalModel {
  std::shared_ptr<ModelStructure> structure;
  std::vector<int> rivals;  ///< indices of effects between which the explanation cannot decide, of the first
                            ///< hidden effect that it leaves open; empty if it decides
  std::vector<int>
      watched;  ///< effects that could become rivals in strokes that do not tell them apart either
  std::vector<EffectChoice> others;
};
RivalModel RivalModelOf(const Explanation& explanation);

/// What strokes say, summed: normal equations over base columns, output and the rivals' columns, the energy
/// of the sensor noise in them and the number of independent equations.
struct RivalEvidence {
  Eigen::MatrixXd total;
  double noise = 0, equations = 0;

  RivalEvidence& Add(const RivalEvidence& other, double times);
};
/// `theta`: base parameters, by which sensor noise counts.
RivalEvidence EvidenceOf(const RivalModel& model, const Eigen::VectorXd& theta,
                         std::span<const StrokeStretches> strokes, const WindowSamples& window);

/// The rivals as directions in the columns of their model, beside what is known to be there.
class Rivals {
 public:
  /// Shapes and sizes are those of each rival in a model with the effects not in question, on `recorded`.
  Rivals(const RivalModel& model, const StrokeSet& recorded);

  /// Energy between the two that are nearest to one another, in noise variances of an equation: the part of
  /// one, at its fitted size, that neither the known nor the other, at whatever sizes, can take over. 0 where
  /// the recorded strokes cannot size two of them. That of a rival and a watched effect counts twice.
  double Nearest(const RivalEvidence& evidence) const;

 private:
  Eigen::MatrixXd known_;
  std::vector<Eigen::VectorXd> unit_;    ///< of rivals, then of watched effects
  std::vector<Eigen::VectorXd> fitted_;  ///< of rivals
};

/// Fewest strokes, kFewestProposed to `most`, that reach kSettledSeparation; `most` if none does.
/// `separation(n)` is that of n strokes and grows with n.
int StrokesToSettle(int most, const std::function<double(int)>& separation);

}  // namespace hydroscope
