#pragma once

#include "diagnosis/effect_ranking.h"
#include "diagnosis/explain.h"

namespace hydroscope {

/// Whether balance and effects are expressions of the user's (model "expressions"): a library small enough
/// that all its subsets can be compared.
bool IsOwnMachine(const ModelStructure& model);

/// What a machine of the user's own misses, on top of `start`: the best subset of its effects
/// (diagnosis/subset_search.h) and those that these strokes cannot tell from it. `named` and `ambiguous` if
/// it brings the error down as far as ExplainOptions::floor_excess and left_share ask for, else `unknown`,
/// with the subset as the nearest.
Explanation ExplainBySubsets(const StrokeSet& strokes, const ExplainOptions& options,
                             const CandidateModel& start);

}  // namespace hydroscope
