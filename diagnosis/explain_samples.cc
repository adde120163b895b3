#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <optional>

#include "core/constants.h"
#include "core/contains.h"
#include "diagnosis/effect_ranking.h"
#include "diagnosis/effect_swap.h"
#include "diagnosis/explain.h"
#include "diagnosis/explain_own_machine.h"
#include "diagnosis/nonlinear_scatter.h"
#include "diagnosis/odd_strokes.h"
#include "diagnosis/refine.h"
#include "diagnosis/remainder/residuals.h"
#include "diagnosis/remainder/tone_search.h"
#include "diagnosis/remainder/whiteness.h"
#include "diagnosis/sample_grams.h"
#include "diagnosis/step_in_place.h"
#include "diagnosis/testability.h"

namespace hydroscope {
namespace {

constexpr int kRounds = 4;
constexpr double kSettled = 0.005;  ///< change of the excess ratio

/// An effect to refine, in a model that has the others.
struct Refinement {
  EffectChoice choice;
  std::vector<EffectChoice> others;
};

/// The effects a candidate was added to.
std::vector<EffectChoice> Before(const ExtendedFit& fit) {
  std::vector<EffectChoice> choices;
  for (std::size_t k = 0; k + 1 < fit.effects.size(); ++k) choices.push_back(fit.effects[k].choice);
  return choices;
}

/// Effects that come close to the best and can be refined.
std::vector<Refinement> CloseTo(const Explanation& found, const ExplainOptions& options) {
  std::vector<Refinement> work;
  for (const auto& ranking : {found.ranking, found.second})
    for (const RankedEffect& r : ranking)
      if (r.fit.solved && !found.model->effects[r.effect]->nonlinear.empty() &&
          r.gain > std::max(options.min_gain, options.close_gain * ranking.front().gain))
        work.push_back({r.fit.effects.back().choice, Before(r.fit)});
  return work;
}

bool IsKnownBeforehand(const NonlinearParameter& parameter) { return parameter.std > 0; }

/// A law with one parameter, or one whose values are known beforehand, keeps none but refined shapes: the
/// grid was for finding it.
void DropGrid(ModelStructure& model) {
  for (std::size_t e = 0; e < model.effects.size(); ++e) {
    auto& shapes = model.effect_shapes[e];
    const bool any =
        std::any_of(shapes.begin(), shapes.end(), [](const EffectShape& s) { return s.refined && !s.on; });
    const auto& nonlinear = model.effects[e]->nonlinear;
    if (any &&
        (model.effects[e]->implied || std::any_of(nonlinear.begin(), nonlinear.end(), IsKnownBeforehand)))
      std::erase_if(shapes, [](const EffectShape& s) { return !s.refined; });
  }
}

/// The model with effects that no grid holds, if what an explanation leaves shows one; else nothing.
std::shared_ptr<const ModelStructure> WithSearchedEffects(const Explanation& found,
                                                          std::span<const StrokeStretches> strokes,
                                                          const ExplainOptions& options) {
  const bool open = found.verdict == Verdict::kUnknown || found.partial || !options.floor_believable;
  if (!open || !found.final.solved) return nullptr;
  auto wider = std::make_shared<ModelStructure>(*found.model);
  const bool any = AddSearchedShapes(*wider, strokes, ColumnWeights(*wider, found.final));
  return any ? wider : nullptr;
}

/// Of two effects found, each with its twin in its place: what the pair leaves tells them apart only once
/// both are refined. Twins have one nonlinear parameter of the same unit, which is where they start.
void RefineTwins(ModelStructure& model, std::span<const StrokeStretches> strokes, const WindowSamples& window,
                 const Explanation& found) {
  if (found.chosen.size() < 2) return;
  for (auto k = static_cast<std::size_t>(found.started); k < found.chosen.size(); ++k) {
    const std::vector<double> values =
        found.model->effect_shapes[found.chosen[k].effect][found.chosen[k].shape].nonlinear;
    for (const std::string& id : TwinsOf(model, model.effects[found.chosen[k].effect]->id))
      for (int e = 0; e < static_cast<int>(model.effects.size()); ++e) {
        if (model.effects[e]->id != id || model.effects[e]->nonlinear.size() != values.size()) continue;
        std::vector<EffectChoice> choices = found.chosen;
        choices[k] = {e, AddShape(model, e, values)};
        RefineModel(model, strokes, window, choices);
      }
  }
}

/// `first`: the model that those asked for grow from.
StrokesUnder StrokesOf(std::shared_ptr<const ModelStructure> first, std::span<const StrokeStretches> strokes,
                       const WindowSamples& window, double noise_scale) {
  const auto grams = std::make_shared<GrowingGrams>(std::move(first), strokes, window);
  return [grams, window, noise_scale](std::shared_ptr<const ModelStructure> model) {
    std::vector<StrokeGram> of_model = grams->Of(model);
    return StrokeSet(std::move(model), std::move(of_model), window, noise_scale);
  };
}

/// The chain with shapes refined on the samples, its noise as ExplainOptions::noise_scale says.
Explanation ExplainRefined(std::shared_ptr<const ModelStructure> model,
                           std::span<const StrokeStretches> strokes, const WindowSamples& window,
                           const ExplainOptions& options) {
  auto with_laws = std::make_shared<ModelStructure>(*model);
  AddSampleEffects(*with_laws);
  AddGenericLaws(*with_laws);
  const StrokesUnder set_of = StrokesOf(with_laws, strokes, window, options.noise_scale);
  if (!options.start.empty()) {
    const CandidateModel start = StartModel(set_of(with_laws), options.start);
    RefineModel(*with_laws, strokes, window, start.choices);
    DropGrid(*with_laws);
  }
  model = with_laws;
  ExplainOptions first_look = options;
  first_look.second_t = options.first_look_t;
  Explanation out = Explain(set_of(model), first_look);
  if (const auto wider = WithSearchedEffects(out, strokes, options)) {
    model = wider;
    out = Explain(set_of(model), first_look);
  }
  for (int round = 0; round < kRounds; ++round) {
    auto refined = std::make_shared<ModelStructure>(*model);
    const int columns = refined->column_count();
    RefineModel(*refined, strokes, window, out.chosen);
    if (round == 0) RefineTwins(*refined, strokes, window, out);
    if (round == 0)
      for (const Refinement& close : CloseTo(out, options))
        RefineOne(*refined, strokes, window, close.others, close.choice);
    const bool strict = round > 0 || out.chosen.size() < 2;
    if (refined->column_count() == columns && strict) return out;
    DropGrid(*refined);
    model = refined;
    const double excess_before = out.final.excess_ratio;
    out = Explain(set_of(model), options);
    if (out.chosen.empty()) return out;
    const bool all_refined = std::all_of(out.chosen.begin(), out.chosen.end(), [&](const EffectChoice& c) {
      return model->effects[c.effect]->nonlinear.empty() || model->effect_shapes[c.effect][c.shape].refined;
    });
    const bool settled = all_refined && std::abs(excess_before - out.final.excess_ratio) < kSettled;
    if (settled || (all_refined && out.chosen.size() < 2 && out.verdict != Verdict::kUnknown)) return out;
  }
  return out;
}

/// What can be predicted of the errors before and after.
void FindWhatIsLeft(std::span<const StrokeStretches> strokes, const WindowSamples& window,
                    const ExplainOptions& options, Explanation& out) {
  if (!out.base.solved) return;
  const std::array<const ExtendedFit*, 2> fits = {&out.base, &out.final};
  const bool same = out.final.effects.size() == out.base.effects.size();
  const auto left = PredictabilityOf(*out.model, strokes, window, std::span(fits).first(same ? 1 : 2),
                                     options.predictability);
  out.base_left = left.front();
  out.final_left = left.back();
}

/// A verdict that leaves something that functions of the signals predict is none.
void ObjectIfPredictable(const ExplainOptions& options, Explanation& out) {
  PredictabilityOptions limits = options.predictability;
  limits.of_base = std::max(limits.of_base, options.left_share);
  if (options.floor_believable) limits.min_share = std::max(limits.min_share, limits.min_share_at_floor);
  const double before = out.set.empty() ? 0.0 : out.base_left.predictable();
  if (out.verdict == Verdict::kUnknown || !out.final_left.IsStructured(limits, before) ||
      out.final_left.predictable() <= out.trifle)
    return;
  out.doubt =
      Tell("{:.0f} % of the energy of what it leaves goes with {}",
           "{:.0f} % der Energie des Rests gehen mit {}", 100 * out.final_left.share, out.final_left.about);
  out.partial = !out.set.empty();
  out.verdict = Verdict::kUnknown;
  out.set.clear();
  out.groups.clear();
}

/// Errors that go on from block to block are no sensor noise, however small they are: the model is not adequate, and a
/// name is no more than a part of the truth.
void ObjectIfItGoesOn(std::span<const StrokeStretches> strokes, const WindowSamples& window,
                      Explanation& out) {
  if (out.verdict == Verdict::kUnknown || out.partial) return;
  const Whiteness left =
      WhitenessOf(ResidualsOf(out.model, strokes, window, ColumnWeights(*out.model, out.final)));
  if (!left.IsStructured() || left.share * left.variance_ratio * out.final.noise_variance <= out.trifle)
    return;
  out.doubt =
      Tell("{:.0f} % of what it leaves goes on from block to block, as white sensor noise does not",
           "{:.0f} % des Rests setzen sich von Block zu Block fort, was weißes Sensorrauschen nicht tut",
           100 * left.share);
  if (out.verdict == Verdict::kAdequate)
    out.verdict = Verdict::kUnknown;
  else
    out.partial = true;
}

Explanation ExplainWithFloor(std::shared_ptr<const ModelStructure> model,
                             std::span<const StrokeStretches> strokes, const WindowSamples& window,
                             const ExplainOptions& options) {
  Explanation out = ExplainRefined(model, strokes, window, options);
  out.noise_scale = options.noise_scale;  // as stated, where it is
  FindWhatIsLeft(strokes, window, options, out);
  ObjectIfPredictable(options, out);
  ObjectIfItGoesOn(strokes, window, out);
  return out;
}

/// Rounds of finding the noise from what the model found leaves, and the model with that noise.
constexpr int kNoiseRounds = 3;
/// Change of the noise energy below which another round would say the same.
constexpr double kNoiseSettled = 0.1;
/// Where the noise shares do not hold: noise is what cannot be predicted, first of the error of the model as
/// it is, then of that of the model found.
Explanation ExplainWithoutFloor(std::shared_ptr<const ModelStructure> model,
                                std::span<const StrokeStretches> strokes, const WindowSamples& window,
                                ExplainOptions options) {
  options.noise_scale = options.evidence_scale = 1;
  const auto plain = std::make_shared<ModelStructure>(*model);
  const CandidateModel start =
      StartModel(StrokeSet(plain, GramsOf(plain, strokes, window), window), options.start);
  if (!start.fit.solved) return ExplainRefined(model, strokes, window, options);
  const std::array<const ExtendedFit*, 1> fits = {&start.fit};
  Predictability left = PredictabilityOf(*plain, strokes, window, fits, options.predictability).front();
  if (!left.tested) return ExplainWithFloor(model, strokes, window, options);
  Explanation out;
  for (int round = 0; round < kNoiseRounds && left.tested; ++round) {
    const double scale = left.left() / start.fit.noise_variance;
    if (round > 0 && scale > (1 - kNoiseSettled) * options.noise_scale) break;
    options.noise_scale = scale;
    options.evidence_scale = std::max(1.0, left.correlation / options.white_correlation);
    out = ExplainRefined(model, strokes, window, options);
    FindWhatIsLeft(strokes, window, options, out);
    out.noise_scale = options.noise_scale;
    left = out.final_left;
  }
  ObjectIfPredictable(options, out);
  if (options.noise_is_white) ObjectIfItGoesOn(strokes, window, out);
  return out;
}

/// A model that needs nothing is adequate, though a law was found that gains a little, if that may as well be of size zero
/// once the freedom of its shape counts. One that gains more than freedom does is no all-clear, and no name either.
void RefuseWhatMayBeZero(const ExplainOptions& options, Explanation& out) {
  const auto first = out.final.effects.begin() + static_cast<std::ptrdiff_t>(out.started);
  if (out.set.empty() || !options.IsDownToNoise(out.base) ||
      std::none_of(first, out.final.effects.end(),
                   [](const EffectEstimate& e) { return std::abs(e.size) < kNormal95 * e.std; }))
    return;
  out.small_error = out.ranking.front().gain > options.most_by_shape;
  out.verdict = out.small_error ? Verdict::kUnknown : Verdict::kAdequate;
  out.doubt = {};
  if (out.small_error)
    out.doubt = Tell(
        "{} would explain it, but with the shape of its law free its size may as well be zero",
        "{} würde ihn erklären, doch bei freier Form seines Gesetzes kann seine Größe ebenso gut null sein",
        out.set.front());
  out.partial = false;
  out.set.clear();
  out.groups.clear();
  out.final = out.base;
  out.final_left = out.base_left;
  out.chosen.resize(static_cast<std::size_t>(out.started));
  out.steps.resize(1);
}

bool NothingPredicts(const Predictability& left, const ExplainOptions& options) {
  return left.tested && (left.share < options.nothing_share || left.p_value > options.nothing_p);
}

/// An error above the floor that nothing predicts, and so small that the noise test may have missed its colour.
bool IsFloorToBlame(const Explanation& x, const ExplainOptions& options) {
  return x.final.excess_ratio + 1 < options.hidden_colour && NothingPredicts(x.final_left, options);
}

/// That the model misses something is not said of an error that may be noise of another colour than what neighbouring rows show.
void AllowForNoise(const ExplainOptions& options, Explanation& x) {
  x.may_be_noise = x.verdict == Verdict::kUnknown && x.base.solved && x.set.empty() && !x.partial &&
                   !x.small_error && x.odd_strokes.empty() && x.remainder <= options.doubt_remainder &&
                   1 + x.final.excess_ratio < options.any_colour && NothingPredicts(x.final_left, options);
  if (x.may_be_noise && x.doubt.empty())
    x.doubt = Tell("its energy is {:.2g} times that of the noise that neighbouring rows show",
                   "seine Energie ist das {:.2g}-fache des Rauschens, das benachbarte Zeilen zeigen",
                   1 + x.final.excess_ratio);
}

/// Share by which noise may be more than neighbouring rows promise without a word.
constexpr double kTold = 0.01;

/// Noise above what neighbouring rows promise, if it is more than is left without a word.
void TellOfFloor(Explanation& x) {
  const double above = std::sqrt(x.noise_scale) - 1;
  if (above < kTold) return;
  x.warnings.push_back(Tell(
      "the error is {:.0f} % above what neighbouring rows promise, and nothing predicts "
      "it: taken as noise that is not quite white",
      "der Fehler liegt {:.0f} % über dem, was benachbarte Zeilen versprechen, und nichts sagt ihn voraus: "
      "er gilt als Rauschen, das nicht ganz weiß ist",
      100 * above));
}

/// Laws of general shape that are weighed against names: as many as six signals have. Of each pair of many signals they would
/// be thousands, whose products no memory holds.
constexpr std::size_t kMostGeneralLaws = 111;

/// The model with those of its general laws that gain most on top of it, each by itself.
std::shared_ptr<const ModelStructure> WithFewerGeneralLaws(std::shared_ptr<const ModelStructure> model,
                                                           std::span<const StrokeStretches> strokes,
                                                           const WindowSamples& window,
                                                           const ExplainOptions& options) {
  const auto& laws = model->generic_laws;
  if (laws.size() <= kMostGeneralLaws) return model;
  std::vector<std::pair<double, std::shared_ptr<const Effect>>> gains;
  for (std::size_t first = 0; first < laws.size(); first += kMostGeneralLaws) {
    const auto some = std::span(laws).subspan(first, std::min(kMostGeneralLaws, laws.size() - first));
    auto part = std::make_shared<ModelStructure>(*model);
    AddLibrary({some.begin(), some.end()}, *part);
    const StrokeSet set(part, GramsOf(part, strokes, window), window);
    const CandidateModel start = StartModel(set, options.start);
    if (!start.fit.solved) break;
    for (const RankedEffect& law : EffectRanking(set, options, start.fit.noise_variance).RankGeneric(start))
      gains.emplace_back(law.gain, part->effects[law.effect]);
  }
  std::ranges::stable_sort(gains, std::greater{}, [](const auto& law) { return law.first; });
  gains.resize(std::min(gains.size(), kMostGeneralLaws));
  auto fewer = std::make_shared<ModelStructure>(*model);
  fewer->generic_laws.clear();
  for (const auto& [gain, law] : gains) fewer->generic_laws.push_back(law);
  return fewer;
}

/// What a model is tried on.
struct Samples {
  std::shared_ptr<const ModelStructure> model;
  std::span<const StrokeStretches> strokes;
  const WindowSamples& window;
};

/// The explanation of all strokes as one.
Explanation ExplainAsOne(const Samples& samples, const ExplainOptions& options) {
  const auto& [model, strokes, window] = samples;
  Explanation out = options.floor_believable ? ExplainWithFloor(model, strokes, window, options)
                                             : ExplainWithoutFloor(model, strokes, window, options);
  if (out.base.solved) {
    const std::span<const EffectChoice> chosen(out.chosen);
    WidenByNonlinear(out.model, strokes, window, chosen.first(out.started), out.base);
    WidenByNonlinear(out.model, strokes, window, chosen, out.final);
    RefuseWhatMayBeZero(options, out);
  }
  return out;
}

/// What explains some strokes apart from the others, in place of `out`, which ExplainAsOne made: that itself where nothing does better.
Explanation Parted(const Samples& samples, const ExplainOptions& options, Explanation out) {
  const auto& [model, strokes, window] = samples;
  if (out.verdict != Verdict::kUnknown || !out.base.solved) return out;
  // An effect, or a law without a name, brings it down to the noise: no other strokes or floor would settle the doubt.
  if (out.nameless || (out.small_error && out.final.effects.size() > out.base.effects.size())) return out;
  const StrokesUnder under = StrokesOf(out.model, strokes, window, out.noise_scale);
  ExplainOptions scaled = options;
  scaled.noise_scale = out.noise_scale;
  scaled.evidence_scale = out.evidence_scale;
  auto parted = ExplainOddStrokes(under(out.model), out, scaled, under);
  if (parted && !parted->partial) return std::move(*parted);
  if (!parted && options.floor_believable && IsFloorToBlame(out, options)) {
    Explanation without = ExplainWithoutFloor(model, strokes, window, options);
    if (without.verdict != Verdict::kUnknown) {
      TellOfFloor(without);
      return without;
    }
  }
  // A name in doubt, of strokes parted at will, gives way to one change, if that leaves no doubt or the name strokes without a cause.
  auto changed = ExplainChange(under(out.model), out, scaled, under);
  if (changed && (!parted || !changed->partial || !HaveACause(parted->odd_strokes)))
    return std::move(*changed);
  return parted ? std::move(*parted) : out;
}

/// Of a group of effects what courses of the temperature and of time may be taken for one another.
enum class MovesWith { kNone, kTime, kTemperatureFromASetPoint };

/// A law of the temperature with a free temperature at which it vanishes is also an error that was there before, and grew with time.
MovesWith MovesWithOf(const ModelStructure& model, const std::vector<std::string>& group) {
  std::size_t drifting = 0, from_a_set_point = 0;
  for (const auto& effect : model.effects) {
    if (!Contains(group, effect->id)) continue;
    drifting += !effect->drifting.empty();
    from_a_set_point += !effect->nonlinear.empty() && effect->nonlinear.front().unit == "K";
  }
  if (drifting == group.size()) return MovesWith::kTime;
  return drifting == 0 && from_a_set_point > 0 ? MovesWith::kTemperatureFromASetPoint : MovesWith::kNone;
}

/// What moves with time may as well follow the oil temperature, and the other way round, where the two rise together so evenly that a
/// law of the one in place of the other would leave nothing to see.
void DoubtTime(std::span<const StrokeStretches> strokes, const ExplainOptions& options, Explanation& out) {
  if (out.partial) return;
  for (const auto& group : out.groups) {
    const MovesWith with = MovesWithOf(*out.model, group);
    if (with == MovesWith::kNone) continue;
    const bool measured = out.model->temperature_channel >= 0;
    const double apart = 1 - SharedCourse(strokes, out.model->temperature_channel);
    const double excess = std::max(0.0, out.base.excess_ratio);
    if (measured && apart * excess > options.floor_excess + options.left_share * excess) continue;
    out.partial = true;
    if (with == MovesWith::kTemperatureFromASetPoint)
      out.doubt = Tell(
          "the oil temperature moved evenly with time: an error that was there from the beginning and grows with time "
          "would look the same",
          "die Öltemperatur lief gleichmäßig mit der Zeit: ein Fehler, der von Anfang an da war und mit der Zeit wächst, "
          "sähe genauso aus");
    else if (measured)
      out.doubt =
          Tell("the oil temperature moved evenly with time: a law of the temperature would look the same",
               "die Öltemperatur lief gleichmäßig mit der Zeit: ein Gesetz der Temperatur sähe genauso aus");
    else
      out.doubt =
          Tell("the oil temperature is not measured: a law of the temperature may look the same",
               "die Öltemperatur wird nicht gemessen: ein Gesetz der Temperatur kann genauso aussehen");
  }
}

/// What may drift evenly may as well have changed once, where one step leaves less of the error.
void DoubtDrift(std::span<const StrokeStretches> strokes, const WindowSamples& window, Explanation& out) {
  if (out.partial || !out.odd_strokes.empty()) return;
  std::optional<StrokeSet> set;
  for (std::size_t group = 0; group < out.groups.size(); ++group)
    for (const auto& effect : out.model->effects) {
      if (effect->drifting.empty() || !Contains(out.groups[group], effect->id)) continue;
      if (!set) set.emplace(StrokesOf(out.model, strokes, window, out.noise_scale)(out.model));
      const auto step = StepInPlaceOf(*set, out, static_cast<std::size_t>(out.started) + group, *effect);
      if (!step) continue;
      out.partial = true;
      out.doubt = Tell(
          "one step of {0} at {1:.0f} s explains it better: see what happened then, and explain "
          "the strokes before and after it by themselves",
          "ein einziger Sprung von {0} bei {1:.0f} s erklärt es besser: nachsehen, was da geschah, und die "
          "Hübe davor und danach für sich erklären",
          step->parameter, strokes[step->stroke].front().begin);
      return;
    }
}

/// The explanation of the model as it is, with the swap that does better. One that explains all strokes comes before strokes that
/// are parted, unless these leave no doubt and it does: a wrong effect suits some strokes better than others, which makes none odd.
Explanation ExplainOrSwap(const Samples& samples, const ExplainOptions& options,
                          const std::function<void(Explanation&)>& doubt) {
  const Explanation whole = ExplainAsOne(samples, options);
  std::map<std::string, Explanation> others;
  const auto without = [&](const std::string& id) {
    ExplainOptions rest = options;
    std::erase(rest.start, id);
    return rest;
  };
  const auto as_one = [&](const std::string& id) {
    const auto at = others.find(id);
    return at != others.end() ? at->second : (others[id] = ExplainAsOne(samples, without(id)));
  };
  Explanation swapped = whole;
  doubt(swapped);
  swapped.swap = BestSwap(options, swapped, as_one);
  if (swapped.swap && swapped.swap->proven) return swapped;
  Explanation out = Parted(samples, options, whole);
  doubt(out);
  if (swapped.swap && swapped.swap->explains && (out.verdict == Verdict::kUnknown || out.partial))
    return swapped;
  const auto parted = [&](const std::string& id) { return Parted(samples, without(id), as_one(id)); };
  out.swap = BestSwap(options, out, parted);
  return out;
}

}  // namespace

Explanation ExplainSamples(std::shared_ptr<const ModelStructure> model,
                           std::span<const StrokeStretches> samples, const WindowSamples& window,
                           const ExplainOptions& asked) {
  const std::vector<StrokeStretches> strokes = WithDerivedChannels(*model, samples);
  ExplainOptions options = asked;
  AddUntestable(*model, strokes, options.untestable);
  model = WithFewerGeneralLaws(std::move(model), strokes, window, options);
  return ExplainOrSwap({model, strokes, window}, options, [&](Explanation& x) {
    AllowForNoise(options, x);
    if (IsOwnMachine(*model)) return;
    DoubtDrift(strokes, window, x);
    DoubtTime(strokes, options, x);
  });
}

}  // namespace hydroscope
