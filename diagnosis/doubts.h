#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "diagnosis/effect_ranking.h"

namespace hydroscope {

/// What speaks against being sure of a set of effects that explains the strokes (Explanation::doubt): the reasons one by one.
class Doubts {
 public:
  /// The references must outlive it; `start` is the model before any effect was looked for.
  Doubts(const StrokeSet& strokes, const ExplainOptions& options, const CandidateModel& start,
         const EffectRanking& ranking)
      : strokes_(strokes), options_(options), start_(start), ranking_(ranking) {}

  /// The gravest of an explanation whose remainder, margin and groups are known; "" if there is none. `at_floor`: the model found
  /// is at the floor without the allowance for two effects that act on one another.
  Told Of(const Explanation& found, bool at_floor) const;
  /// Which of its effects, counted from the first one found, is a delay so small that a signal may only seem late: between two
  /// rows it is taken to move evenly, and it need not.
  struct UnseenDelay {
    std::size_t effect = 0;
    bool integrated =
        false;  ///< so small that it is how the flow between rows is integrated (ExplainOptions::integrated_rows)
    Told why;
  };
  std::optional<UnseenDelay> MayMoveBetweenRows(const Explanation& found) const;

 private:
  std::string MeasuredAndLeftOut(const ExtendedFit& fit) const;
  bool MayBeChance(const Explanation& found) const;
  Told ValueAtItsLimit(const Explanation& found) const;
  std::optional<std::pair<std::string, std::string>> Relatives(
      const std::vector<std::vector<std::string>>& groups) const;
  double LeastShare(const Explanation& found) const;

  const StrokeSet& strokes_;
  const ExplainOptions& options_;
  const CandidateModel& start_;
  const EffectRanking& ranking_;
};

/// Why what an explanation names or leaves to choose from is not proven; "" if it is, or if it names nothing.
Told WhyNotProven(const Explanation& explanation);

}  // namespace hydroscope
