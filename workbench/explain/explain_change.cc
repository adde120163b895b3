#include "workbench/explain/explain_change.h"

#include <algorithm>
#include <cmath>

#include "core/contains.h"

namespace hydroscope {
namespace {

/// Standard errors by which a parameter must move (p = 0.01, two-sided).
constexpr double kMoved = 2.576;

std::vector<std::string> IdsOf(const ModelStructure& model, std::span<const EffectChoice> choices) {
  std::vector<std::string> ids;
  for (const EffectChoice& choice : choices) ids.push_back(model.effects[choice.effect]->id);
  return ids;
}

void AddOnce(std::vector<std::string>& ids, const std::string& id) {
  if (!Contains(ids, id)) ids.push_back(id);
}

/// The last effect of `fit` in the strokes before, in the same model and shape.
class Reference {
 public:
  Reference(const StrokeHistory& before, const Explanation& after)
      : strokes_(after.model, before.units, before.window, before.noise_scale), after_(after) {}

  /// Whether its size differs from that before by `min_t` standard errors. What the strokes before cannot
  /// tell counts as not there.
  bool Differs(const ExtendedFit& fit, double min_t) const {
    std::vector<EffectChoice> choices;
    for (const EffectEstimate& effect : fit.effects) choices.push_back(effect.choice);
    const ExtendedFit earlier = strokes_.Fit(choices);
    if (!earlier.solved) return true;
    const EffectEstimate &now = fit.effects.back(), &then = earlier.effects.back();
    return std::abs(now.size - then.size) > min_t * std::hypot(now.std, then.std);
  }

  /// Effects that stand out after but are no larger than before.
  std::vector<std::string> Unchanged(double min_t) const {
    std::vector<std::string> ids;
    for (const auto* ranking : {&after_.ranking, &after_.second})
      for (const RankedEffect& ranked : *ranking)
        if (ranked.fit.solved && ranked.significant && !Differs(ranked.fit, min_t)) AddOnce(ids, ranked.id);
    return ids;
  }

 private:
  StrokeSet strokes_;
  const Explanation& after_;
};

/// Explains the strokes after without the effects that are no larger than before.
Result<ExplainResult> ExplainAfter(const StrokeHistory& before, const StrokeHistory& after,
                                   ExplainOptions options) {
  for (;;) {
    auto result = ExplainUnits(after, options);
    if (!result) return result;
    const std::vector<std::string> unchanged =
        Reference(before, result->explanation).Unchanged(options.min_t);
    if (unchanged.empty()) return result;
    options.exclude.insert(options.exclude.end(), unchanged.begin(), unchanged.end());
  }
}

/// The newer half of one machine's strokes, at least kFewestUnits.
StrokeHistory NewerHalf(const StrokeHistory& history) {
  StrokeHistory half = history;
  const std::size_t kept = std::max(kFewestUnits, (history.units.size() + 1) / 2);
  const auto from = static_cast<std::ptrdiff_t>(history.units.size() - kept);
  half.units.erase(half.units.begin(), half.units.begin() + from);
  half.unit_parts.erase(half.unit_parts.begin(), half.unit_parts.begin() + from);
  half.parts.front().first = half.unit_parts.front().first;
  std::erase_if(half.sample, [&](const StrokeSummary& s) { return s.index < half.parts.front().first; });
  return half;
}

/// Explains the newest strokes among those after that one size of an effect explains; `newest` is set to
/// them. Without any, the explanation of all of them. Where all of them show a part of an effect, it must be that; where they
/// show none, for some of them are as healthy as those before, the newest must name one without a doubt.
Result<ExplainResult> ExplainNewest(const StrokeHistory& before, StrokeHistory& newest,
                                    const ExplainOptions& options) {
  auto all = ExplainAfter(before, newest, options);
  if (!all || all->explanation.verdict != Verdict::kUnknown || newest.parts.size() != 1) return all;
  const std::vector<ExplainStep>& steps = all->explanation.steps;
  for (StrokeHistory part = newest; part.units.size() > kFewestUnits;) {
    part = NewerHalf(part);
    auto result = ExplainAfter(before, part, options);
    if (!result) break;
    const Explanation& found = result->explanation;
    if (steps.size() > 1 ? !Contains(found.set, steps[1].added) : found.set.empty() || found.partial)
      continue;
    newest = std::move(part);
    return result;
  }
  return all;
}

std::vector<ValueChange> ParameterChanges(const StrokeHistory& before, const StrokeHistory& after,
                                          const ChangeResult& result) {
  const auto of = [](const StrokeHistory& history, const ExplainResult& side) {
    return BaseParameters(*history.model, side.explanation.final, static_cast<int>(history.units.size()),
                          Tolerances::kLeftOut);
  };
  const std::vector<Estimate> then = of(before, result.before), now = of(after, result.after);
  std::vector<ValueChange> out;
  for (std::size_t i = 0; i < std::min(then.size(), now.size()); ++i) {
    out.push_back(
        {now[i].parameter, now[i].unit, then[i].value, then[i].std, now[i].value, now[i].std, false});
    out.back().significant = std::abs(out.back().change()) > kMoved * out.back().std();
  }
  return out;
}

/// Sizes of the effects both sets have, before and after in one shape: sizes at different thresholds or
/// places say nothing of each other. An effect changed if it did in the shape that suits the strokes after
/// and in the one that suits those before, by `min_t` standard errors, and if its old size would cost the
/// strokes after more than a new effect must gain (min_gain) and more than the model errs there anyway.
/// Beside effects that appeared, the model with the old size must also fail the adequacy gate of two effects,
/// which act on one another (ExplainOptions::interplay).
class EffectComparison {
 public:
  EffectComparison(const StrokeHistory& before, const StrokeHistory& after, const ChangeResult& result,
                   const ExplainOptions& options)
      : then_(result.after.explanation.model, before.units, before.window),
        now_(result.after.explanation.model, after.units, after.window),
        result_(result),
        options_(options) {}

  std::vector<ValueChange> Changes() const {
    std::vector<ValueChange> out;
    const Explanation &before = result_.before.explanation, &after = result_.after.explanation;
    for (std::size_t k = 0; k < before.chosen.size(); ++k)
      for (std::size_t j = 0; j < after.chosen.size(); ++j) {
        if (after.chosen[j].effect != before.chosen[k].effect) continue;
        ValueChange change = In(after.chosen[j], j);
        const int shape = ShapeBefore(before.chosen[k]);
        change.significant =
            change.significant && shape >= 0 && In({after.chosen[j].effect, shape}, j).significant;
        out.push_back(std::move(change));
      }
    return out;
  }

  /// Effects that explain the strokes after as well as a change of `id` does, if that keeps its old size:
  /// ExplainOptions::rival_gain. None beside effects that appeared.
  std::vector<std::string> Rivals(const std::string& id) const {
    const Explanation& after = result_.after.explanation;
    std::vector<std::string> rivals;
    if (static_cast<int>(after.chosen.size()) > after.started) return rivals;
    const ExtendedFit then = then_.Fit(after.chosen);
    for (std::size_t j = 0; then.solved && j < after.chosen.size(); ++j) {
      if (result_.after.effect(after.chosen[j].effect).id != id) continue;
      for (const RankedEffect& rival : after.ranking) {
        if (!rival.fit.solved) continue;
        const EffectEstimate &was = then.effects[j], &is = rival.fit.effects[j];
        const double kept = std::pow((is.size - was.size) / std::hypot(is.model_std, was.model_std), 2);
        if (kept - std::max(0.0, rival.gain) < options_.rival_gain) rivals.push_back(rival.id);
      }
    }
    return rivals;
  }

 private:
  /// The shape of the strokes before among those of the model after, -1 if it is not there.
  int ShapeBefore(const EffectChoice& choice) const {
    const auto& was = result_.before.explanation.model->effect_shapes[choice.effect][choice.shape].nonlinear;
    const auto& shapes = now_.model().effect_shapes[choice.effect];
    const auto at = std::ranges::find_if(shapes, [&](const EffectShape& s) { return s.nonlinear == was; });
    return at == shapes.end() ? -1 : static_cast<int>(at - shapes.begin());
  }

  /// What the evidence for a change must exceed, in noise variances.
  double Needed() const {
    const Explanation& after = result_.after.explanation;
    double error = std::max(0.0, after.final.excess_ratio);
    if (static_cast<int>(after.chosen.size()) > after.started)
      error = std::max(error, options_.floor_excess - after.final.excess_ratio +
                                  options_.interplay * options_.left_share * after.base.excess_ratio);
    return options_.min_gain + now_.equations() * error;
  }

  /// Before and after with effect `j` of the model after in one shape.
  ValueChange In(const EffectChoice& choice, std::size_t j) const {
    const Explanation& after = result_.after.explanation;
    std::vector<EffectChoice> later = after.chosen;
    later[j] = choice;
    const std::vector<EffectChoice> earlier(later.begin(), later.begin() + after.started);
    const ExtendedFit now = now_.Fit(later), then = then_.Fit(earlier);
    const Effect& effect = result_.after.effect(choice.effect);
    if (!now.solved || !then.solved) return {effect.id, effect.unit, 0, 0, 0, 0, false};
    const EffectEstimate &a = then.effects[j], &b = now.effects[j];
    ValueChange change{effect.id, effect.unit, a.size, a.std, b.size, b.std, false};
    const double evidence = std::pow(change.change() / std::hypot(a.model_std, b.model_std), 2);
    change.significant = std::abs(change.change()) > options_.min_t * change.std() && evidence > Needed();
    return change;
  }

  StrokeSet then_, now_;
  const ChangeResult& result_;
  const ExplainOptions& options_;
};

/// New effects that remove less of the error that appeared than they leave do not explain it: a model whose
/// own effects changed errs in its own ways, and some law follows a part of that.
void RefuseSmallShares(double excess_before, Explanation& after) {
  const double left = after.final.excess_ratio - std::max(0.0, excess_before);
  if (after.set.empty() || after.base.excess_ratio - after.final.excess_ratio >= left) return;
  after.verdict = Verdict::kUnknown;
  after.partial = true;
  after.set.clear();
  after.groups.clear();
  after.doubt = {};
}

/// What no parameters of an episode take away counts as its noise. Where that grew, no parameters that moved are all: a law that
/// is missing looks so.
void RefuseWhereEpisodesErrMore(const ExplainResult& before, ExplainResult& after) {
  if (after.explanation.verdict != Verdict::kAdequate || after.EachAlone()) return;
  if (std::pow(after.error_alone / before.error_alone, 2) > 1 + kFloorExcess)
    after.explanation.verdict = Verdict::kUnknown;
}

}  // namespace

double ValueChange::std() const { return std::hypot(before_std, after_std); }

Result<ChangeResult> ExplainChange(const StrokeHistory& before, const StrokeHistory& after,
                                   const ExplainOptions& options) {
  auto then = TRY(ExplainHistory(before, options));
  ChangeResult result{std::move(then), {}, {}, {}, {}, 0};
  const Explanation& earlier = result.before.explanation;
  ExplainOptions own = OptionsForEquations(options, after.equations());
  own.start = IdsOf(*earlier.model, earlier.chosen);
  own.floor_excess += std::max(0.0, earlier.final.excess_ratio);
  StrokeHistory newest = after;
  auto now = TRY(ExplainNewest(before, newest, own));
  if (newest.units.size() < after.units.size()) result.newest = newest.strokes();
  result.after = std::move(now);

  Explanation& later = result.after.explanation;
  RefuseSmallShares(earlier.final.excess_ratio, later);
  RefuseWhereEpisodesErrMore(result.before, result.after);
  TakeFloors(newest, result.after);
  TakeConfoundings(newest.units, result.after);
  result.appeared = later.set;
  result.parameters = ParameterChanges(before, newest, result);
  const EffectComparison comparison(before, newest, result, own);
  result.effects = comparison.Changes();
  for (const ValueChange& effect : result.effects) {
    // In a model that does not explain the strokes before, a size has no name.
    if (!effect.significant || later.verdict == Verdict::kUnknown || earlier.verdict == Verdict::kUnknown)
      continue;
    std::vector<std::string> group = comparison.Rivals(effect.name);
    group.insert(group.begin(), effect.name);  // it was there and grew or shrank
    for (const std::string& id : group) AddOnce(later.set, id);
    if (group.size() > 1) later.verdict = Verdict::kAmbiguous;
    if (later.verdict == Verdict::kAdequate) later.verdict = Verdict::kNamed;
    later.groups.push_back(std::move(group));
  }
  DoubtForUnmeasured(after.machine, later);
  DoubtForTwinNotStored(later);
  return result;
}

Result<ChangeResult> ExplainChange(const Database& database, const std::string& path,
                                   const HistoryPart& before, const HistoryPart& after,
                                   const ExplainOptions& options) {
  const auto machine = TRY(StoredMachine(database, path, after));
  const auto then = TRY(LoadHistory(database, path, {before}, machine));
  const auto now = TRY(LoadHistory(database, path, {after}, machine));
  return ExplainChange(then, now, options);
}

}  // namespace hydroscope
