#pragma once

#include <optional>

#include "workbench/explain/explain_log.h"
#include "workbench/history/stroke_history.h"

namespace hydroscope {

/// Options for so many equations: evidence that the model's own small errors, which no number of strokes averages out,
/// give to a wrong effect grows with the number of equations, so the evidence asked for grows alike.
ExplainOptions OptionsForEquations(ExplainOptions options, double equations);

/// Finds what the model in force misses on stored strokes. Nonlinear parameters come from the grid of the
/// library, interpolated. `location` stays empty: that needs samples. Errors: fewer than kMinExplainStrokes
/// units, an effect of the machine that is not in the library, or strokes that do not excite the model.
/// ExplainOptions::start is taken from the machine.
Result<ExplainResult> ExplainHistory(const StrokeHistory& history, const ExplainOptions& options = {});

/// The same, and where a few strokes are to blame that nothing explains all of them, as `explain` of a log says it: the explanation
/// of the others, and what is so in these (Explanation::odd_strokes). Of strokes stored one by one alone: in a sum of several an odd
/// one does not show by itself.
Result<ExplainResult> ExplainHistoryButForOdd(const StrokeHistory& history);

/// An explanation that is parted so; nothing where it is not unknown, or no few strokes are to blame. Its strokes are `units`.
std::optional<Explanation> ButForOddUnits(const StrokeHistory& history, const Explanation& whole);

/// The noise floors of its fits, as `history` knows what the noise is like.
void TakeFloors(const StrokeHistory& history, ExplainResult& result);

/// Flags a set of which a twin is in no stored Gram (Effect::twins, Effect::needs_samples): it was not tried.
void DoubtForTwinNotStored(Explanation& x);
/// The same of causes that need a signal the machine file does not have (untried_causes.h).
void DoubtForUnmeasured(const Machine& machine, Explanation& x);

/// The same with `options` as they are: start, thresholds and all.
Result<ExplainResult> ExplainUnits(const StrokeHistory& history, const ExplainOptions& options);

}  // namespace hydroscope
