#include "diagnosis/odd_strokes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

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

}  // namespace

std::vector<std::size_t> FindOddStrokes(const StrokeSet& strokes, std::span<const EffectChoice> start,
                                        const ExplainOptions& explain, const OddStrokeOptions& options) {
  const auto count = static_cast<std::size_t>(strokes.strokes());
  std::vector<std::size_t> rest(count), out;
  std::iota(rest.begin(), rest.end(), 0);
  bool described = false;
  const auto share = static_cast<std::size_t>(std::ceil((1 - options.most) * static_cast<double>(count)));
  while (rest.size() >= std::max(options.least, share)) {
    const StrokeSet set = strokes.Only(rest);
    const ExtendedFit fit = set.Fit(start);
    if (!fit.solved) return {};
    described = fit.excess_ratio <= explain.floor_excess;
    if (described) break;
    const std::size_t worst = Worst(set, fit);
    out.push_back(rest[worst]);
    rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(worst));
  }
  if (!described || out.empty()) return {};
  std::vector<std::size_t> odd;
  for (const std::size_t s : out)
    if (IsOdd(strokes, rest, s, start, options)) odd.push_back(s);
  std::sort(odd.begin(), odd.end());
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

/// What explains the odd strokes against the rest, whose explanation is `rest`.
Explanation ExplainAgainst(const StrokeSet& strokes, const std::vector<std::size_t>& odd,
                           const Explanation& rest, const ExplainOptions& explain) {
  ExplainOptions beside = explain;
  beside.start.clear();
  for (const EffectChoice& choice : rest.chosen)
    beside.start.push_back(strokes.model().effects[choice.effect]->id);
  return Explain(strokes.WithEffectsIn(odd, rest.chosen), beside);
}

/// What explains most of the odd strokes against the rest. One that a change began or ended in shows it in
/// part only, so the first and the last of them may be left out.
struct OddExplained {
  OddStrokes strokes;
  Explanation explanation;
};
std::optional<OddExplained> ExplainMost(const StrokeSet& strokes, const std::vector<std::size_t>& odd,
                                        const Explanation& rest, const ExplainOptions& explain,
                                        const OddStrokeOptions& options) {
  constexpr std::array<std::pair<std::size_t, std::size_t>, 4> kEnds = {{{0, 0}, {1, 0}, {0, 1}, {1, 1}}};
  for (const auto& [first, last] : kEnds) {
    if (odd.size() < options.least_named + first + last) return std::nullopt;
    const std::vector<std::size_t> left(odd.begin() + static_cast<std::ptrdiff_t>(first),
                                        odd.end() - static_cast<std::ptrdiff_t>(last));
    std::vector<std::size_t> used = RestOf(strokes, odd);
    used.insert(used.end(), left.begin(), left.end());
    std::sort(used.begin(), used.end());
    std::vector<std::size_t> places;  // of `left` among `used`
    for (const std::size_t s : left)
      places.push_back(
          static_cast<std::size_t>(std::lower_bound(used.begin(), used.end(), s) - used.begin()));
    Explanation found = ExplainAgainst(strokes.Only(used), places, rest, explain);
    if (!found.partial && !found.set.empty()) return OddExplained{{left, found.set}, std::move(found)};
  }
  return std::nullopt;
}

/// Few, or one after another.
bool MayDifferWithoutCause(const std::vector<std::size_t>& odd, int strokes,
                           const OddStrokeOptions& options) {
  const auto count = static_cast<double>(odd.size());
  const auto stretch = static_cast<double>(odd.back() - odd.front() + 1);
  return count <= std::max(1.0, std::round(options.most_scattered * strokes)) ||
         count >= options.together * stretch;
}

std::optional<Explanation> Parted(const StrokeSet& strokes, std::span<const EffectChoice> by,
                                  const ExplainOptions& explain, const OddStrokeOptions& options) {
  std::vector<std::size_t> odd = FindOddStrokes(strokes, by, explain, options);
  if (odd.empty()) return std::nullopt;
  Explanation out = Explain(strokes.Only(RestOf(strokes, odd)), explain);
  if (out.verdict == Verdict::kUnknown) return std::nullopt;
  if (auto most = ExplainMost(strokes, odd, out, explain, options)) {
    if (out.verdict == Verdict::kAdequate) out = std::move(most->explanation);
    std::erase_if(odd, [&](std::size_t s) {
      return std::binary_search(most->strokes.strokes.begin(), most->strokes.strokes.end(), s);
    });
    out.odd_strokes.push_back(std::move(most->strokes));
  }
  if (odd.empty()) return out;
  // Under coloured noise strokes stand out for no more than a slow swing of it.
  if (out.verdict == Verdict::kAdequate && explain.floor_believable &&
      !MayDifferWithoutCause(odd, strokes.strokes(), options))
    return std::nullopt;
  out.odd_strokes.push_back({std::move(odd), {}});
  return out;
}

}  // namespace

std::optional<Explanation> ExplainOddStrokes(const StrokeSet& strokes, const Explanation& whole,
                                             const ExplainOptions& explain, const OddStrokeOptions& options) {
  const std::vector<EffectChoice> start(whole.chosen.begin(), whole.chosen.begin() + whole.started);
  if (auto parted = Parted(strokes, start, explain, options)) return parted;
  for (std::size_t k = 0; k < std::min(options.tried, whole.ranking.size()); ++k) {
    if (!whole.ranking[k].fit.solved || whole.ranking[k].gain < explain.min_gain) continue;
    std::vector<EffectChoice> by = start;
    by.push_back(whole.ranking[k].fit.effects.back().choice);
    if (auto parted = Parted(strokes, by, explain, options)) return parted;
  }
  return std::nullopt;
}

}  // namespace hydroscope
