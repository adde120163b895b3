#pragma once

#include "diagnosis/effect_ranking.h"

namespace hydroscope {

/// Sets margin and margin_law of `out`. Generic laws stand for effects that are not in the library. One that explains the error as
/// well as what was found, or as one of two effects beside the other, and is not much the same as that effect, shows that the name
/// rests on what happens to be in the library. `start`: the model as it is.
void FindMargin(const StrokeSet& strokes, const ExplainOptions& options, const CandidateModel& start,
                const EffectRanking& ranking, Explanation& out);

}  // namespace hydroscope
