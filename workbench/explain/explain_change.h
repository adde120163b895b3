#pragma once

#include <string>
#include <vector>

#include "workbench/explain/explain_history.h"

namespace hydroscope {

/// A number of the model before and after.
struct ValueChange {
  std::string name;  ///< K, V0, ... or the id of an effect, whose size it is
  std::string unit;  ///< SI
  double before = 0, before_std = 0;
  double after = 0, after_std = 0;
  bool significant = false;

  double change() const { return after - before; }
  double std() const;
};

/// What changed between two sets of strokes.
struct ChangeResult {
  /// The model before; its verdict says what the model in force had missed already then.
  ExplainResult before;
  /// The strokes after, explained on what explained those before. Verdict: adequate - no physical effect
  /// appeared; named - the effects of `set` appeared or grew; ambiguous - one of several did; unknown - the
  /// error grew and no effect explains it.
  ExplainResult after;
  std::vector<ValueChange> parameters;  ///< of the base model; free in both sets
  std::vector<ValueChange> effects;     ///< that were in the model before, free in both sets, in one shape
  std::vector<std::string> appeared;    ///< effects that only the strokes after need, best first
  /// Newest strokes after that `after` speaks of; 0 = all. Fewer where what appeared went on changing: wear grows.
  std::int64_t newest = 0;
};

inline constexpr std::size_t kFewestUnits = 8;

/// What changed from the strokes of `before` to those of `after`. The base parameters are free in both, an
/// effect is admitted in those after only: it must lower their error on strokes left out, and its size must
/// differ from what the strokes before say by ExplainOptions::min_t standard errors. A model error that was
/// there before already does not count as a change. An effect that was there before changed if, both sets
/// fitted in one shape, its old size costs the strokes after ExplainOptions::min_gain and more than model
/// errors can feign. If no effect of one size explains all strokes after, but one explains part of their
/// error or some of them are healthy, the newest half, quarter, ... of one machine's strokes is explained instead, down to kFewestUnits.
/// Errors as ExplainHistory; both must be of the same model.
Result<ChangeResult> ExplainChange(const StrokeHistory& before, const StrokeHistory& after,
                                   const ExplainOptions& options = {});

/// The same for two parts of a database, with the model in force.
Result<ChangeResult> ExplainChange(const Database& database, const std::string& path,
                                   const HistoryPart& before, const HistoryPart& after,
                                   const ExplainOptions& options = {});

}  // namespace hydroscope
