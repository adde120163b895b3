#pragma once

#include <vector>

#include "diagnosis/effect_ranking.h"

namespace hydroscope {

/// Relative difference of the errors of two models on strokes left out that decides nothing between them.
inline constexpr double kSameError = 0.005;

/// Of the search over all subsets of a small library. What they name and miss `hydroscope benchmark own-machines` counts.
struct SubsetOptions {
  int max_effects = 4;       ///< in one subset
  int max_candidates = 20;   ///< of more, those that lower the error most by themselves: 6195 subsets
  int fitted = 24;           ///< subsets of each size that are judged on strokes left out
  double min_t = 4.0;        ///< size of every effect over its standard error by strokes
  double sure_t = 6.0;       ///< ... at which a larger subset is taken though its losses scatter
  double better_t = 2.5;     ///< standard errors by which a larger subset, or a better one, must err less
  double far_worse = 1.4;    ///< ... or times the error: twice the energy
  double rival_gain = 12.0;  ///< subsets within this of the best stay rivals: error energy on strokes left
                             ///< out, in variances of what the best leaves per equation
  double min_gain = 40.0;    ///< error energy that a larger subset must remove, in noise variances ...
  double min_share = 0.05;   ///< ... and as a share of the model error's energy that the smaller one leaves
};

struct SubsetResult {
  CandidateModel best;  ///< `start` itself if no subset does better
  /// Subsets of the same size that these strokes cannot tell from the best, best first; all on top of start.
  std::vector<CandidateModel> rivals;
};

/// The subset of `candidates` (effects of the model, each of one column in every shape) that describes the
/// strokes best on top of `start`. All subsets of up to max_effects are solved on the sum of all Grams with
/// the start model projected out (after Furnival and Wilson 1974, "Regressions by leaps and bounds"; with
/// four effects at most no bound is needed). Of each size those with the least error, of sizes that physics
/// allows, are fitted with one stroke left out at a time. A subset counts if each of its effects is seen
/// (min_t) and lowers the error on strokes left out, in the units shown; it takes the place of a smaller one
/// if it errs less, stroke by stroke, by better_t standard errors or with effects all beyond sure_t.
/// Nonlinear shapes: best alone, then best beside the others of the subset found.
SubsetResult SearchSubsets(const StrokeSet& strokes, const CandidateModel& start,
                           const std::vector<int>& candidates, const SubsetOptions& options = {});

}  // namespace hydroscope
