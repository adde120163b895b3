#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "diagnosis/explain.h"

namespace hydroscope {

/// Thresholds of the search for odd strokes, calibrated by `hydroscope benchmark plant-logs`.
struct OddStrokeOptions {
  double most = 0.4;      ///< share of the strokes that may be odd: more, and who is to say which ones are
  std::size_t least = 4;  ///< strokes that the rest must have
  int draws = 40;  ///< of `least` strokes at random: one in ten is without odd ones where four tenths are odd
  int steps = 6;   ///< fits that follow each draw, at most
  std::uint64_t seed = 1999;  ///< of the draws
  double clear = 0.5;       ///< error energy per noise energy of a stroke that is odd, as the rest models it
  double deviations = 6.0;  ///< ... and in standard deviations of what noise makes of so many equations
  std::size_t least_named = 2;  ///< odd strokes that an effect must be seen in, each left out in turn
  /// Effects that gain most, the best of each family, each tried as what the rest misses.
  std::size_t tried = 6;
  /// Share of the strokes that may be odd without a cause while nothing is missed in the rest, unless they fill this share
  /// of their stretch of the log: strokes scattered over a log rather are those in which an error of all shows most.
  double most_scattered = 0.1, together = 0.75;
  double most_changed = 0.75;  ///< share of the strokes past a change that must be odd
  std::size_t most_between =
      2;  ///< strokes that a change begins or ends in: like neither side, they need no cause
  /// What an effect must explain of the odd strokes beyond what another value of one parameter of the model does, which is the
  /// plainer of the two: noise variances, and a share of what the effect explains.
  double beyond_parameter = 10.0, beyond_share = 0.02;
};

/// The strokes of a log under another model over the same channels; empty: their samples are gone.
using StrokesUnder = std::function<StrokeSet(std::shared_ptr<const ModelStructure>)>;

/// Strokes without which the model `start` describes the rest down to the floor: the worst is taken out until it does (forward
/// trimming), or the rest is found by least trimmed squares; then those that the rest describes after all are taken back. Empty
/// if the log cannot be parted so, or if all strokes are described.
std::vector<std::size_t> FindOddStrokes(const StrokeSet& strokes, std::span<const EffectChoice> start,
                                        const ExplainOptions& explain, const OddStrokeOptions& options = {});

/// The strokes from a single change of the log on, or, if only those are described by the model `start`, the ones before it, however
/// many. Empty if neither side is described or one has fewer than `least` strokes.
std::vector<std::size_t> FindStrokesPastChange(const StrokeSet& strokes, std::span<const EffectChoice> start,
                                               const ExplainOptions& explain,
                                               const OddStrokeOptions& options = {});

/// An explanation in place of `whole`, of verdict unknown, if a few strokes are to blame: that of the rest, and of
/// the odd strokes against it (an effect at work in these alone). Strokes are parted by the model as it is, then
/// by it and one of the effects that gain most. If the rest misses nothing, verdict and set are those of the odd
/// strokes. `strokes` has the model of `whole`, and `under` builds the same of other models: laws that a size ties to a shape have
/// another one in the odd strokes than in all. nullopt if none are odd, or the rest is not described either.
std::optional<Explanation> ExplainOddStrokes(const StrokeSet& strokes, const Explanation& whole,
                                             const ExplainOptions& explain, const StrokesUnder& under,
                                             const OddStrokeOptions& options = {});

/// Whether the odd strokes have a cause, but for those that a change began or ended in.
bool HaveACause(const std::vector<OddStrokes>& odd, const OddStrokeOptions& options = {});

/// The same where the log is of one kind up to some stroke and of another from there on, however many strokes that are
/// (FindStrokesPastChange): the explanation of the side that is described, and of the other one against it. The cause may be
/// not proven; nullopt if there is none.
std::optional<Explanation> ExplainChange(const StrokeSet& strokes, const Explanation& whole,
                                         const ExplainOptions& explain, const StrokesUnder& under,
                                         const OddStrokeOptions& options = {});

}  // namespace hydroscope
