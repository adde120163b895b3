#include "diagnosis/odd_strokes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>

#include "core/contains.h"
#include "diagnosis/parameter_in_place.h"
#include "diagnosis/refine.h"
#include "diagnosis/remainder/residuals.h"

namespace hydroscope {
namespace {

std::size_t Worst(const StrokeSet& strokes, const ExtendedFit& fit) {
  std::size_t worst = 0;
  for (std::size_t s = 1; s < static_cast<std::size_t>(strokes.strokes()); ++s)
    if (strokes.ExcessRatio(fit, s) > strokes.ExcessRatio(fit, worst)) worst = s;
  return worst;
}

/// Whether the rest, as fitted, does not describe stroke `s` of all.
bool IsOdd(const StrokeSet& all, std::span<const std::size_t> rest, std::size_t s,
           std::span<const EffectChoice> start, const OddStrokeOptions& options) {
  std::vector<std::size_t> with(rest.begin(), rest.end());
  with.push_back(s);
  const StrokeSet set = all.Only(with);
  const ExtendedFit fit = set.Fit(start);
  if (!fit.solved) return true;
  const std::size_t last = with.size() - 1;
  const double chance = std::sqrt(2.0 / std::max(1.0, set.Equations(last)));
  return set.ExcessRatio(fit, last) > std::max(options.clear, options.deviations * chance);
}

using Strokes = std::vector<std::size_t>;

bool AreDescribed(const ExtendedFit& fit, const ExplainOptions& explain) {
  return fit.solved && fit.excess_ratio <= explain.floor_excess;
}

/// All but the worst, and the next, until the rest is described (forward trimming); empty if fewer than `least` would be.
Strokes WithoutTheWorst(const StrokeSet& strokes, std::span<const EffectChoice> start,
                        const ExplainOptions& explain, std::size_t least) {
  Strokes rest(static_cast<std::size_t>(strokes.strokes()));
  std::iota(rest.begin(), rest.end(), 0);
  while (rest.size() >= least) {
    const StrokeSet set = strokes.Only(rest);
    const ExtendedFit fit = set.Fit(start);
    if (!fit.solved) break;
    if (AreDescribed(fit, explain)) return rest;
    rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(Worst(set, fit)));
  }
  return {};
}

/// The `count` strokes in whose equations `error` has the least energy, in order.
Strokes BestDescribed(const StrokeSet& strokes, std::span<const Eigen::MatrixXd> grams,
                      const Eigen::VectorXd& error, std::size_t count) {
  std::vector<std::pair<double, std::size_t>> energies;
  for (std::size_t s = 0; s < grams.size(); ++s)
    energies.emplace_back(error.dot(grams[s] * error) / std::max(1.0, strokes.Equations(s)), s);
  std::sort(energies.begin(), energies.end());
  Strokes best;
  for (std::size_t k = 0; k < count; ++k) best.push_back(energies[k].second);
  std::sort(best.begin(), best.end());
  return best;
}

/// The `count` strokes that one model describes best, where so many others bend the fit of all that these do not look the worst:
/// from few strokes drawn at random, each fit is followed by that of the strokes which it describes best (least trimmed squares by
/// concentration steps, Rousseeuw and Van Driessen 1999), until one's excess is `enough`. Empty if no draw leads to any.
Strokes Concentrated(const StrokeSet& strokes, std::span<const EffectChoice> start, std::size_t count,
                     double enough, const OddStrokeOptions& options) {
  const std::vector<Eigen::MatrixXd> grams = strokes.TotalOfEach();
  std::mt19937_64 random(options.seed);
  Strokes all(grams.size()), best;
  std::iota(all.begin(), all.end(), 0);
  double least = std::numeric_limits<double>::infinity();
  for (int draw = 0; draw < options.draws; ++draw) {
    Strokes used;
    std::sample(all.begin(), all.end(), std::back_inserter(used), options.least, random);
    for (int step = 0; step < options.steps; ++step) {
      const ExtendedFit fit = strokes.Only(used).Fit(start);
      if (!fit.solved) break;
      if (used.size() == count && fit.excess_ratio < least) {
        best = used;
        least = fit.excess_ratio;
        if (least <= enough) return best;
      }
      Strokes next = BestDescribed(strokes, grams, ErrorWeights(strokes.model(), fit), count);
      if (next == used) break;
      used = std::move(next);
    }
  }
  return best;
}

/// Strokes that the rest must have at least.
std::size_t LeastOf(const StrokeSet& strokes, const OddStrokeOptions& options) {
  const double share = std::ceil((1 - options.most) * static_cast<double>(strokes.strokes()));
  return std::max(options.least, static_cast<std::size_t>(share));
}

/// The number of strokes before a single change: where two models, one before and one from there on, leave least of the error
/// (Quandt 1960). 0 if no place leaves `least` strokes on either side.
std::size_t StrokesBeforeAChange(const StrokeSet& strokes, std::span<const EffectChoice> start,
                                 std::size_t least) {
  const auto count = static_cast<std::size_t>(strokes.strokes());
  Strokes all(count);
  std::iota(all.begin(), all.end(), 0);
  const auto left_of = [&](std::span<const std::size_t> part) {
    const StrokeSet set = strokes.Only(part);
    const ExtendedFit fit = set.Fit(start);
    return fit.solved ? fit.excess_ratio * set.equations() : std::numeric_limits<double>::infinity();
  };
  std::size_t before = 0;
  double fewest = std::numeric_limits<double>::infinity();
  for (std::size_t k = least; k + least <= count; ++k) {
    const std::span<const std::size_t> of_all(all);
    const double left = left_of(of_all.first(k)) + left_of(of_all.subspan(k));
    if (left < fewest) before = k, fewest = left;
  }
  return before;
}

}  // namespace

std::vector<std::size_t> FindStrokesPastChange(const StrokeSet& strokes, std::span<const EffectChoice> start,
                                               const ExplainOptions& explain,
                                               const OddStrokeOptions& options) {
  const auto count = static_cast<std::size_t>(strokes.strokes());
  const std::size_t before = StrokesBeforeAChange(strokes, start, options.least);
  if (before == 0) return {};
  Strokes all(count);
  std::iota(all.begin(), all.end(), 0);
  const auto part = [&](std::size_t from, std::size_t to) {
    return Strokes(all.begin() + static_cast<std::ptrdiff_t>(from),
                   all.begin() + static_cast<std::ptrdiff_t>(to));
  };
  // The side that is described, and the other one if it is not: most of its strokes at least, for some may hardly show the change.
  const auto other_than = [&](std::size_t from, std::size_t to) {
    if (to - from < options.least) return Strokes{};
    const Strokes rest = part(from, to);
    if (!AreDescribed(strokes.Only(rest).Fit(start), explain)) return Strokes{};
    Strokes other = from == 0 ? part(to, count) : part(0, from);
    const auto odd =
        std::ranges::count_if(other, [&](std::size_t s) { return IsOdd(strokes, rest, s, start, options); });
    return static_cast<double>(odd) >= options.most_changed * static_cast<double>(other.size()) ? other
                                                                                                : Strokes{};
  };
  // The stroke in which it changed is like neither side.
  for (const auto& [from, to] : {std::pair<std::size_t, std::size_t>{0, before},
                                 {0, before - 1},
                                 {before, count},
                                 {before + 1, count}})
    if (Strokes odd = other_than(from, to); !odd.empty()) return odd;
  return {};
}

std::vector<std::size_t> FindOddStrokes(const StrokeSet& strokes, std::span<const EffectChoice> start,
                                        const ExplainOptions& explain, const OddStrokeOptions& options) {
  const auto count = static_cast<std::size_t>(strokes.strokes());
  const std::size_t least = LeastOf(strokes, options);
  if (least >= count) return {};
  Strokes rest = WithoutTheWorst(strokes, start, explain, least);
  if (rest.empty()) rest = Concentrated(strokes, start, least, explain.floor_excess, options);
  if (rest.empty() || !AreDescribed(strokes.Only(rest).Fit(start), explain)) return {};
  Strokes odd;
  for (std::size_t s = 0; s < count; ++s)
    if (!std::binary_search(rest.begin(), rest.end(), s) && IsOdd(strokes, rest, s, start, options))
      odd.push_back(s);
  return odd;
}

namespace {

/// The strokes that are not in `odd`, which is sorted.
std::vector<std::size_t> RestOf(const StrokeSet& strokes, const std::vector<std::size_t>& odd) {
  std::vector<std::size_t> rest;
  for (std::size_t s = 0; s < static_cast<std::size_t>(strokes.strokes()); ++s)
    if (!std::binary_search(odd.begin(), odd.end(), s)) rest.push_back(s);
  return rest;
}

/// A law of time or of the oil's temperature: it singles out no strokes.
bool NeverPauses(const Effect& effect, const ModelStructure& model) {
  return !effect.drifting.empty() ||
         (effect.least_span && effect.least_span->channel == model.temperature_channel);
}

void LeaveOutWhatNeverPauses(const ModelStructure& model, std::map<std::string, Told>& untestable) {
  for (const auto& effect : model.effects)
    if (NeverPauses(*effect, model))
      untestable.emplace(effect->id, Tell("it would show in all strokes, not in some alone",
                                          "er zeigte sich in allen Hüben, nicht nur in einigen"));
}

constexpr int kShapings = 3;  ///< of laws tied to their size

using PartOf = std::function<StrokeSet(const StrokeSet&)>;

/// Explains `part` of the strokes. Laws tied to their size have another shape in it than in all: `strokes` gets those.
Explanation ExplainPart(StrokeSet& strokes, const PartOf& part, const ExplainOptions& explain,
                        const StrokesUnder& under) {
  Explanation out = Explain(part(strokes), explain);
  for (int k = 0; under && k < kShapings; ++k) {
    auto model = std::make_shared<ModelStructure>(*out.model);
    bool any = false;
    for (const RankedEffect& r : out.ranking)
      if (r.fit.solved && r.gain > explain.min_gain) any = AddImpliedShape(*model, r.fit) || any;
    if (!any) break;
    strokes = under(std::move(model));
    out = Explain(part(strokes), explain);
  }
  return out;
}

/// What explains the odd strokes, places among the strokes `used`, against the others, whose explanation is `rest`.
Explanation ExplainAgainst(StrokeSet& strokes, std::span<const std::size_t> used,
                           std::span<const std::size_t> odd, const Explanation& rest,
                           const ExplainOptions& explain, const StrokesUnder& under) {
  ExplainOptions beside = explain;
  beside.start.clear();
  for (const EffectChoice& choice : rest.chosen)
    beside.start.push_back(strokes.model().effects[choice.effect]->id);
  LeaveOutWhatNeverPauses(strokes.model(), beside.untestable);
  return ExplainPart(
      strokes, [&](const StrokeSet& all) { return all.Only(used).WithEffectsIn(odd, rest.chosen); }, beside,
      under);
}

/// What explains most of the odd strokes against the rest. One that a change began or ended in shows it in
/// part only, so the first and the last of them may be left out. `in_doubt`: a cause that is not proven counts too.
struct OddExplained {
  OddStrokes strokes;
  Explanation explanation;
};
std::optional<OddExplained> ExplainMost(StrokeSet strokes, const std::vector<std::size_t>& odd,
                                        const Explanation& rest, bool in_doubt, const ExplainOptions& explain,
                                        const StrokesUnder& under, const OddStrokeOptions& options) {
  constexpr std::array<std::pair<std::size_t, std::size_t>, 4> kEnds = {{{0, 0}, {1, 0}, {0, 1}, {1, 1}}};
  std::optional<OddExplained> doubtful, otherwise;
  for (const auto& [first, last] : kEnds) {
    if (odd.size() < options.least_named + first + last) break;
    const std::vector<std::size_t> left(odd.begin() + static_cast<std::ptrdiff_t>(first),
                                        odd.end() - static_cast<std::ptrdiff_t>(last));
    std::vector<std::size_t> used = RestOf(strokes, odd);
    used.insert(used.end(), left.begin(), left.end());
    std::sort(used.begin(), used.end());
    std::vector<std::size_t> places;  // of `left` among `used`
    for (const std::size_t s : left)
      places.push_back(
          static_cast<std::size_t>(std::lower_bound(used.begin(), used.end(), s) - used.begin()));
    Explanation found = ExplainAgainst(strokes, used, places, rest, explain, under);
    const bool explains = !found.partial && !found.set.empty();
    ParameterInPlace in_place =
        ParameterInPlaceOf(found, explains, strokes.Only(left), rest.final, explain, options);
    if (!in_place.by_one.empty()) return OddExplained{{left, {}, std::move(in_place.by_one)}, rest};
    if (!in_place.by_each.empty()) {
      OddExplained by_each{{left, {}, std::move(in_place.by_each)}, rest};
      if (explains) return by_each;
      if (!otherwise && rest.verdict == Verdict::kAdequate) otherwise = std::move(by_each);
    }
    if (explains) return OddExplained{{left, found.set}, std::move(found)};
    if (in_doubt && !doubtful && !found.set.empty() && AreDescribed(found.final, explain))
      doubtful = OddExplained{{left, found.set, {}, found.doubt}, std::move(found)};
  }
  return doubtful ? doubtful : otherwise;
}

/// One after another.
bool AreTogether(const std::vector<std::size_t>& odd, const OddStrokeOptions& options) {
  const auto stretch = static_cast<double>(odd.back() - odd.front() + 1);
  return static_cast<double>(odd.size()) >= options.together * stretch;
}

/// Few, or one after another.
bool MayDifferWithoutCause(const std::vector<std::size_t>& odd, int strokes,
                           const OddStrokeOptions& options) {
  const auto count = static_cast<double>(odd.size());
  return count <= std::max(1.0, std::round(options.most_scattered * strokes)) || AreTogether(odd, options);
}

/// Time and temperature run from the first stroke to the last: a law of theirs that leaves strokes at an end of the log
/// undescribed is not the one.
bool MissesAnEnd(const Explanation& found, const std::vector<std::size_t>& odd, int strokes) {
  const auto is_odd = [&](int s) {
    return std::binary_search(odd.begin(), odd.end(), static_cast<std::size_t>(s));
  };
  if (!(is_odd(0) && is_odd(1)) && !(is_odd(strokes - 1) && is_odd(strokes - 2))) return false;
  return std::any_of(found.chosen.begin() + found.started, found.chosen.end(), [&](const EffectChoice& c) {
    return NeverPauses(*found.model->effects[c.effect], *found.model);
  });
}

/// Laws that are relatives; an effect without any stands for itself.
const std::string& FamilyOf(const Effect& effect) {
  return effect.family.empty() ? effect.id : effect.family.english;
}

/// The explanation of all but the strokes `odd`, and of these against it.
std::optional<Explanation> Parted(StrokeSet strokes, Strokes odd, bool in_doubt,
                                  const ExplainOptions& explain, const StrokesUnder& under,
                                  const OddStrokeOptions& options) {
  if (odd.empty()) return std::nullopt;
  const std::vector<std::size_t> rest = RestOf(strokes, odd);
  Explanation out = ExplainPart(
      strokes, [&](const StrokeSet& all) { return all.Only(rest); }, explain, under);
  if (out.verdict == Verdict::kUnknown) return std::nullopt;
  // As many as a rest must have, one after another, are the side of a change where nothing else is missed.
  const bool change =
      out.verdict == Verdict::kAdequate && odd.size() >= options.least && AreTogether(odd, options);
  if (auto most = ExplainMost(strokes, odd, out, in_doubt || change, explain, under, options)) {
    if (out.verdict == Verdict::kAdequate) out = std::move(most->explanation);
    std::erase_if(odd, [&](std::size_t s) {
      return std::binary_search(most->strokes.strokes.begin(), most->strokes.strokes.end(), s);
    });
    out.odd_strokes.push_back(std::move(most->strokes));
  }
  if (odd.empty()) return out;
  if (MissesAnEnd(out, odd, strokes.strokes())) return std::nullopt;
  const bool scattered = !MayDifferWithoutCause(odd, strokes.strokes(), options);
  const bool adequate = out.verdict == Verdict::kAdequate;
  // Under coloured noise strokes stand out for no more than a slow swing of it.
  if (scattered && adequate && explain.floor_believable) return std::nullopt;
  if (scattered && !adequate) {
    out.partial = true;
    if (out.doubt.empty())
      out.doubt =
          Tell("{} of {} strokes, scattered over the log, had to be left out, and nothing says why",
               "{} von {} Hüben, über das Log verstreut, mussten ausgelassen werden, und nichts sagt, warum",
               odd.size(), strokes.strokes());
  }
  out.odd_strokes.push_back({std::move(odd), {}});
  return out;
}

/// A way to part strokes.
struct Parting {
  /// Which are odd, by a model and the effects beside it.
  std::function<Strokes(const StrokeSet&, std::span<const EffectChoice>)> odd_by;
  bool in_doubt;  ///< of ExplainMost
};

/// Parted by the model as it is and one of the effects that gain most in `ranked`, the best of each family.
std::optional<Explanation> PartedByOneOf(const Explanation& ranked, const StrokeSet& strokes,
                                         std::span<const EffectChoice> start, const Parting& parting,
                                         const ExplainOptions& explain, const StrokesUnder& under,
                                         const OddStrokeOptions& options) {
  std::vector<std::string> families;
  for (const RankedEffect& r : ranked.ranking) {
    if (families.size() == options.tried) break;
    if (!r.fit.solved || r.gain < explain.min_gain) continue;
    const std::string& family = FamilyOf(*ranked.model->effects[r.effect]);
    if (Contains(families, family)) continue;
    families.push_back(family);
    std::vector<EffectChoice> by(start.begin(), start.end());
    by.push_back(r.fit.effects.back().choice);
    if (auto parted = Parted(strokes, parting.odd_by(strokes, by), parting.in_doubt, explain, under, options))
      return parted;
  }
  return std::nullopt;
}

/// Where the effects that gain most in all strokes do not part them, those do that gain most in the strokes described best: strokes
/// that err much hide what all have.
std::optional<Explanation> PartedByTheBest(const StrokeSet& strokes, std::span<const EffectChoice> start,
                                           const Parting& parting, const ExplainOptions& explain,
                                           const StrokesUnder& under, const OddStrokeOptions& options) {
  const std::size_t least = LeastOf(strokes, options);
  if (least >= static_cast<std::size_t>(strokes.strokes())) return std::nullopt;
  const Strokes best = Concentrated(strokes, start, least, -std::numeric_limits<double>::infinity(), options);
  if (best.empty()) return std::nullopt;
  StrokeSet shaped = strokes;
  const Explanation of_best = ExplainPart(
      shaped, [&](const StrokeSet& all) { return all.Only(best); }, explain, under);
  return PartedByOneOf(of_best, shaped, start, parting, explain, under, options);
}

}  // namespace

bool HaveACause(const std::vector<OddStrokes>& odd, const OddStrokeOptions& options) {
  std::size_t without = 0;
  for (const OddStrokes& part : odd)
    if (part.set.empty() && part.parameter.empty()) without += part.strokes.size();
  return without <= options.most_between;
}

std::optional<Explanation> ExplainOddStrokes(const StrokeSet& strokes, const Explanation& whole,
                                             const ExplainOptions& explain, const StrokesUnder& under,
                                             const OddStrokeOptions& options) {
  const std::span start(whole.chosen.data(), static_cast<std::size_t>(whole.started));
  const Parting scattered{[&](const StrokeSet& all, std::span<const EffectChoice> by) {
                            return FindOddStrokes(all, by, explain, options);
                          },
                          false};
  auto parted = Parted(strokes, scattered.odd_by(strokes, start), false, explain, under, options);
  if (!parted) parted = PartedByOneOf(whole, strokes, start, scattered, explain, under, options);
  if (!parted) parted = PartedByTheBest(strokes, start, scattered, explain, under, options);
  return parted;
}

std::optional<Explanation> ExplainChange(const StrokeSet& strokes, const Explanation& whole,
                                         const ExplainOptions& explain, const StrokesUnder& under,
                                         const OddStrokeOptions& options) {
  const std::span start(whole.chosen.data(), static_cast<std::size_t>(whole.started));
  const Parting changed{[&](const StrokeSet& all, std::span<const EffectChoice> by) {
                          return FindStrokesPastChange(all, by, explain, options);
                        },
                        true};
  auto parted = Parted(strokes, changed.odd_by(strokes, start), true, explain, under, options);
  if (!parted) parted = PartedByOneOf(whole, strokes, start, changed, explain, under, options);
  if (parted && !HaveACause(parted->odd_strokes, options)) return std::nullopt;
  return parted;
}

}  // namespace hydroscope
