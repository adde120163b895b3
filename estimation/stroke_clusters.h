#pragma once

#include <Eigen/Dense>
#include <span>
#include <string>
#include <vector>

#include "estimation/normal_equations.h"

namespace hydroscope {

/// What strokes that hang together have in common.
enum class ClusterUnit {
  kStroke,          ///< nothing: every stroke counts for itself
  kTime,            ///< they were recorded one after the other
  kOperatingPoint,  ///< a regressor has about the same size
  kLog,             ///< they are of one log
};
/// Machine name ("stroke", "time", "operating_point", "log") for JSON.
const char* ClusterUnitName(ClusterUnit unit);

/// Strokes in groups; a group is left out as a whole.
struct StrokeClusters {
  ClusterUnit unit = ClusterUnit::kStroke;
  std::vector<int> of;  ///< [stroke] number of its group, 0 ... count - 1
  int count = 0;
  int level = -1;  ///< kOperatingPoint: entry of StrokeOperation::level that they share
};

/// How a stroke was driven, as far as strokes may hang together by it.
struct StrokeOperation {
  int log = 0;
  /// Rms of the regressors in the flow form; not of the output, which holds the errors.
  Eigen::VectorXd level;
};

/// Every stroke for itself.
StrokeClusters SingleStrokes(std::size_t count);

/// Parameters with one group left out at a time, a column per group; empty if the rest of the strokes leaves
/// them open for some group.
Eigen::MatrixXd ReplicasWithoutClusters(std::span<const NormalEquations> strokes,
                                        const StrokeClusters& clusters);

/// Covariance of replicas by the delete-a-group jackknife, (G - 1)/G sum (r - mean)(r - mean)'.
Eigen::MatrixXd JackknifeCovariance(const Eigen::MatrixXd& replicas);

/// As how many strokes that are alike these tell of combinations of parameters (`directions`, one per column), of which
/// a few may tell most: (sum c)^2 / sum c^2 of the shares c that strokes have in the variance (Satterthwaite 1946; of
/// groups Bell and McCaffrey 2002). Leaving out one at a time shows a variance no better known than that of so few.
Eigen::VectorXd StrokesThatTell(std::span<const NormalEquations> strokes, const Eigen::MatrixXd& directions);

/// The same of shares whose sum and sum of squares are known; at least two, as one by itself has no scatter.
double AlikeStrokes(double sum_of_shares, double sum_of_squares);

/// Groups in which the strokes' errors hang together, kStroke if nothing speaks against their independence.
/// Groups tried: logs, operating points (values of each level that lie together, else equally many of
/// neighbouring values), times (blocks of consecutive strokes of a log). Each is tried on each parameter: the
/// variance of the jackknife by groups over that by strokes, against the same with the sign of every stroke's
/// score drawn at random (wild cluster bootstrap: Cameron, Gelbach and Miller 2008; the largest over groups
/// and parameters, so that trying many finds none by chance in 95 of 100 sets). Of those that stand out the
/// one with the widest intervals (Cameron and Miller 2015, section III.A) is taken. Fewer than 8 strokes are
/// too few to see anything. `theta` solves the sum of `strokes`.
StrokeClusters FindStrokeClusters(std::span<const NormalEquations> strokes,
                                  std::span<const StrokeOperation> operations, const Eigen::VectorXd& theta);

/// Covariance `alike` by strokes, widened where few of them tell most of a parameter (StrokesThatTell), or where groups
/// give more: `clusters` as FindStrokeClusters gave them. Made for Student's t of strokes - 1 degrees of freedom: what
/// fewer have more is in it.
Eigen::MatrixXd WidenedCovariance(std::span<const NormalEquations> strokes, const StrokeClusters& clusters,
                                  const Eigen::MatrixXd& alike);

}  // namespace hydroscope
