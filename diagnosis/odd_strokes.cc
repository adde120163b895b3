#include "diagnosis/odd_strokes.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace hydroscope {
namespace {

/// Odd strokes that an effect must be seen in, each left out in turn.
constexpr std::size_t kLeastNamed = 3;
/// Effects that gain most, each tried as what the rest misses.
constexpr std::size_t kTried = 4;

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

std::optional<Explanation> Parted(const StrokeSet& strokes, std::span<const EffectChoice> by,
                                  const ExplainOptions& explain, const OddStrokeOptions& options) {
  OddStrokes odd{FindOddStrokes(strokes, by, explain, options), {}};
  if (odd.strokes.empty()) return std::nullopt;
  Explanation out = Explain(strokes.Only(RestOf(strokes, odd.strokes)), explain);
  if (out.verdict == Verdict::kUnknown) return std::nullopt;
  if (odd.strokes.size() >= kLeastNamed) {
    Explanation only = ExplainAgainst(strokes, odd.strokes, out, explain);
    if (!only.partial) odd.set = only.set;
    if (!odd.set.empty() && out.verdict == Verdict::kAdequate) out = std::move(only);
  }
  out.odd_strokes.push_back(std::move(odd));
  return out;
}

}  // namespace

std::optional<Explanation> ExplainOddStrokes(const StrokeSet& strokes, const Explanation& whole,
                                             const ExplainOptions& explain, const OddStrokeOptions& options) {
  const std::vector<EffectChoice> start(whole.chosen.begin(), whole.chosen.begin() + whole.started);
  if (auto parted = Parted(strokes, start, explain, options)) return parted;
  for (std::size_t k = 0; k < std::min(kTried, whole.ranking.size()); ++k) {
    if (!whole.ranking[k].fit.solved || whole.ranking[k].gain < explain.min_gain) continue;
    std::vector<EffectChoice> by = start;
    by.push_back(whole.ranking[k].fit.effects.back().choice);
    if (auto parted = Parted(strokes, by, explain, options)) return parted;
  }
  return std::nullopt;
}

}  // namespace hydroscope
