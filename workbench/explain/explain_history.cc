#include "workbench/explain/explain_history.h"

#include <algorithm>
#include <cmath>

#include "core/contains.h"
#include "core/told_error.h"
#include "diagnosis/effect_ranking.h"
#include "diagnosis/effect_swap.h"
#include "diagnosis/explain_own_machine.h"
#include "diagnosis/interpolated_shapes.h"
#include "diagnosis/odd_strokes.h"
#include "diagnosis/shape_freedom.h"
#include "diagnosis/testability.h"
#include "estimation/floor_trust.h"
#include "models/counted_words.h"
#include "models/find_effect.h"
#include "models/machine_kind.h"
#include "workbench/explain/headline.h"
#include "workbench/explain/untried_causes.h"
#include "workbench/model/machine_model.h"

namespace hydroscope {
namespace {

/// Equations up to which the thresholds of ExplainOptions hold as they are: a log of some minutes.
constexpr double kEquationsOfALog = 2000.0;
/// Effects of the ranking whose nonlinear parameters are looked at between the grid values.
constexpr std::size_t kRefined = 5;

/// Shapes between the grid values for the effects that matter.
std::shared_ptr<const ModelStructure> Refined(const Explanation& x) {
  auto model = std::make_shared<ModelStructure>(*x.model);
  std::vector<int> effects;
  for (const EffectChoice& choice : x.chosen) effects.push_back(choice.effect);
  for (const auto* ranking : {&x.ranking, &x.second})
    for (std::size_t k = 0; k < std::min(kRefined, ranking->size()); ++k)
      effects.push_back((*ranking)[k].effect);
  std::ranges::sort(effects);
  effects.erase(std::unique(effects.begin(), effects.end()), effects.end());
  for (const int effect : effects) AddInterpolatedShapes(*model, effect);
  return model;
}

/// Explains without effects that rest on the shape of another one.
Explanation ExplainRefined(const StrokeSet& strokes, ExplainOptions options) {
  for (;;) {
    Explanation out = Explain(strokes, options);
    const std::vector<std::string> resting = EffectsOfShapes(strokes, out, options);
    if (resting.empty()) return out;
    options.exclude.insert(options.exclude.end(), resting.begin(), resting.end());
  }
}

}  // namespace

ExplainOptions OptionsForEquations(ExplainOptions options, double equations) {
  const double times = std::max(1.0, equations / kEquationsOfALog);
  options.min_gain *= times;
  options.max_remainder *= times;
  options.doubt_remainder *= times;
  options.doubt_margin *= times;
  options.beaten_margin *= times;
  options.rival_gain *= times;
  options.sure_gain *= times;
  return options;
}

namespace {

/// Effects whose law lives on a temperature that hardly moved.
void AddUntestable(const StrokeHistory& history, std::map<std::string, Told>& untestable) {
  std::vector<double> oil;
  for (const StrokeSummary& summary : history.sample)
    if (std::isfinite(summary.oil_temperature)) oil.push_back(summary.oil_temperature);
  for (const auto& effect : history.model->effects) {
    if (!effect->least_span || effect->least_span->channel != history.model->temperature_channel) continue;
    const Told why = WhyUntestable(*effect, oil);
    if (!why.empty()) untestable.emplace(effect->id, why);
  }
}

}  // namespace

namespace {

/// The intervals of the models before and after, their shapes free.
void WidenShown(const StrokeSet& strokes, Explanation& x) {
  if (!x.base.solved) return;
  const std::span<const EffectChoice> chosen(x.chosen);
  WidenByStoredShapes(strokes, chosen.first(static_cast<std::size_t>(x.started)), x.base);
  WidenByStoredShapes(strokes, chosen, x.final);
}

/// What the parameters that suit each episode best leave, over what white noise would; NaN of strokes.
double ErrorOfEachAlone(const StrokeHistory& history, double of_sums) {
  if (!KindOf(history.machine).has_states || !(history.white_noise > 0)) return std::nan("");
  return of_sums / history.white_noise;
}

}  // namespace

Result<ExplainResult> ExplainUnits(const StrokeHistory& history, const ExplainOptions& asked) {
  ExplainOptions options = asked;
  AddUntestable(history, options.untestable);
  const CountedWords counted = CountedWordsOf(history.machine);
  if (history.units.size() < kMinExplainStrokes)
    return BadInput(Tell(
        "{}: {} in the chosen part of the history, expected at least {}: the error is judged on {} left out",
        "{}: {} im gewählten Teil der Geschichte, erwartet mindestens {}: der Fehler wird an ausgelassenen {} beurteilt",
        history.database, counted.CountedTold(history.units.size()), kMinExplainStrokes,
        counted.SeveralDative()));
  for (const std::string& id : options.start) TRY(FindEffect(*history.model, id));
  ExplainResult out;
  options.noise_scale = history.noise_scale;
  options.evidence_scale = std::max(options.evidence_scale, history.evidence_scale);
  const auto strokes_under = [&](std::shared_ptr<const ModelStructure> model) {
    return StrokeSet(std::move(model), history.units, history.window, history.noise_scale);
  };
  out.explanation = Explain(strokes_under(history.model), options);
  if (out.explanation.base.solved &&
      (out.explanation.verdict != Verdict::kAdequate || !options.start.empty()))
    out.explanation = ExplainRefined(strokes_under(Refined(out.explanation)), options);
  out.explanation.noise_scale = history.noise_scale;
  WidenShown(strokes_under(out.explanation.model), out.explanation);
  if (!out.explanation.base.solved)
    return BadInput(Tell(
        "{}: the strokes do not excite all parameters of the model: choose more of them with --from and "
        "--to, or record strokes that differ in {}",
        "{}: die Hübe regen nicht alle Parameter des Modells an: mit --from und --to mehr davon wählen, oder Hübe "
        "aufzeichnen, die sich in {} unterscheiden",
        history.database, history.model->words.vary));
  out.log.machine = history.machine;
  out.log.machine.added_effects = options.start;
  out.log.model = history.model;
  out.log.window = history.window;
  for (const StrokeSummary& summary : history.sample) out.log.strokes.push_back({summary, {}, {}});
  out.strokes = static_cast<std::size_t>(history.strokes());
  out.base = FiguresOf(*out.explanation.model, out.explanation.base, static_cast<int>(history.units.size()));
  out.error_alone = ErrorOfEachAlone(history, out.explanation.base.noise_floor);
  MarkCarriedByError(strokes_under(out.explanation.model), out.explanation.base, out.base);
  RefuseVerdict(history.no_verdict.empty() ? ImpossibleFigures(out.base) : Told{history.no_verdict, ""},
                out.explanation);
  RefuseImpossibleParameters(history.machine, history.units.size(), out.explanation);
  out.unmeasured = UnmeasuredEffects(history.machine, *history.model);
  for (UnmeasuredEffect& effect : NotStoredEffects(*history.model))
    out.unmeasured.push_back(std::move(effect));
  return out;
}

namespace {

/// Why the sums of episodes carry no verdict on the model, "" if they do. They say whether one set of parameters does for all
/// episodes; effects are tried on logs alone, and what no parameters take away may be noise that is not white.
Told WhyEpisodesDoNotTell(const ExplainResult& result) {
  const double ratio = result.error_alone;
  if (std::isnan(ratio)) return {};
  if (result.explanation.verdict != Verdict::kAdequate)
    return result.EachAlone()
               ? Tell(
                     "parameters of its own describe each of these episodes down to the sensor noise, no one set "
                     "describes them all: a parameter moves ('hydroscope trends' shows which)",
                     "eigene Parameter beschreiben jede dieser Episoden bis auf das Sensorrauschen, kein Satz "
                     "beschreibt alle: ein Parameter bewegt sich ('hydroscope trends' zeigt welcher)")
               : Tell(
                     "one set of parameters does not describe these episodes as well as each by itself would: a "
                     "parameter moves ('hydroscope trends' shows which), or an effect is missing, which 'hydroscope "
                     "explain' with the logs names",
                     "ein Satz von Parametern beschreibt diese Episoden nicht so gut wie jede für sich: ein Parameter "
                     "bewegt sich ('hydroscope trends' zeigt welcher), oder ein Effekt fehlt, den 'hydroscope explain' "
                     "mit den Aufzeichnungen nennt");
  if (result.EachAlone()) return {};
  return Tell(
      "the parameters that suit an episode best leave {:.2g} times what white noise would: the noise is not white, or "
      "the model misses something in all of these episodes. Stored sums do not tell the two apart, 'hydroscope "
      "explain' with the logs does",
      "die Parameter, die einer Episode am besten passen, lassen {:.2g}-mal so viel übrig wie weißes Rauschen: das "
      "Rauschen ist nicht weiß, oder dem Modell fehlt in allen diesen Episoden etwas. Gespeicherte Summen trennen "
      "beides nicht, 'hydroscope explain' mit den Aufzeichnungen schon",
      ratio);
}

}  // namespace

void DoubtForUnmeasured(const Machine& machine, Explanation& x) {
  DoubtForUntried(
      machine, [&](int channel) { return x.model->channel_source[channel] >= 0; }, x);
}

void DoubtForTwinNotStored(Explanation& x) {
  for (const std::string& named : x.set)
    for (const std::string& twin : TwinsOf(*x.model, named)) {
      const bool tried =
          std::ranges::any_of(x.model->effects, [&](const auto& effect) { return effect->id == twin; });
      if (tried || Contains(x.untried, twin)) continue;
      x.untried.push_back(twin);
      if (x.partial) continue;
      x.partial = true;
      x.doubt = Tell(
          "{} looks the same and is tried on a log only: stored strokes keep no columns of it",
          "{} sieht genauso aus und wird nur an einer Aufzeichnung versucht: gespeicherte Hübe behalten keine Spalten davon",
          twin);
    }
}

/// A name of a machine's own file stands against laws of general shape, of which stored sums keep no columns.
void DoubtForUntriedLaws(Explanation& x) {
  if (x.partial || x.set.empty() || !IsOwnMachine(*x.model)) return;
  x.partial = true;
  x.doubt = Tell(
      "whether a law that the machine file lacks does better is tried on a log only",
      "ob ein Gesetz, das der Maschinendatei fehlt, es besser erklärt, wird nur an einer Aufzeichnung versucht");
}

/// What stored sums lack, where something is left that no effect explains: the colour of noise, if nobody looked at it while the
/// rows were there, effects at other values of their thresholds and widths than those of the grid, and laws without a name.
void SayWhatALogWouldTell(const StrokeHistory& history, Explanation& x) {
  if (x.verdict != Verdict::kUnknown || x.small_error || !x.doubt.empty()) return;
  const bool shaped = std::ranges::any_of(x.final.effects, [&](const EffectEstimate& e) {
    return !x.model->effects[e.choice.effect]->nonlinear.empty();
  });
  if (!history.noise_known)
    x.doubt = Tell(
        "what is left may be noise that is not white, which 'hydroscope explain' sees in a log of this machine and not in "
        "stored {}",
        "was bleibt, kann Rauschen sein, das nicht weiß ist; 'hydroscope explain' sieht es an einer Aufzeichnung dieser "
        "Maschine, nicht an gespeicherten {}",
        CountedWordsOf(history.machine).SeveralDative());
  else if (shaped)
    x.doubt = Tell(
        "the shape of its law is known on a grid only; 'hydroscope explain' with a log of this machine refines it",
        "die Form seines Gesetzes ist nur auf einem Raster bekannt; 'hydroscope explain' mit einer Aufzeichnung dieser "
        "Maschine verfeinert sie");
  else if (IsOwnMachine(*x.model))
    x.doubt = Tell(
        "a law that the machine file lacks is looked for in a log only; 'hydroscope explain' with one of this machine "
        "proposes what may be missing",
        "ein Gesetz, das der Maschinendatei fehlt, wird nur in einer Aufzeichnung gesucht; 'hydroscope explain' mit einer "
        "dieser Maschine schlägt vor, was fehlen kann");
}

void TakeFloors(const StrokeHistory& history, ExplainResult& result) {
  Explanation& x = result.explanation;
  // What the model lacks may pass for less noise than there is: the log tells, or else the best model found.
  if (x.noise_scale != 1 && history.floor_scale)
    x.final.noise_floor =
        history.NoiseFloor(x.model, {x.chosen.begin(), x.chosen.begin() + x.started}, x.base);
  if (x.noise_scale != 1) result.base.noise_floor = x.final.noise_floor;
  for (double* floor : {&result.base.noise_floor, &x.base.noise_floor, &x.final.noise_floor})
    *floor = history.NoiseFloor(*floor);
}

std::optional<Explanation> ButForOddUnits(const StrokeHistory& history, const Explanation& whole) {
  if (whole.verdict != Verdict::kUnknown || !whole.no_verdict.empty() || !whole.base.solved)
    return std::nullopt;
  ExplainOptions options = OptionsForEquations({}, history.equations());
  options.start = history.machine.added_effects;
  options.noise_scale = whole.noise_scale;
  options.evidence_scale = whole.evidence_scale;
  return ExplainOddStrokes(StrokeSet(whole.model, history.units, history.window, history.noise_scale), whole,
                           options, {});
}

namespace {

void DoubtWhatIsNotStored(const Machine& machine, Explanation& x) {
  if (!x.no_verdict.empty()) return;
  DoubtForUnmeasured(machine, x);
  DoubtForTwinNotStored(x);
  DoubtForUntriedLaws(x);
}

/// The explanation by the model that has the effects of `options` but for one.
Explanation ExplainWithout(const std::string& id, const StrokeHistory& history, ExplainOptions options) {
  std::erase(options.start, id);
  auto result = ExplainUnits(history, options);
  if (!result) return {};
  DoubtWhatIsNotStored(history.machine, result->explanation);
  return std::move(result->explanation);
}

/// Whether each stroke is stored by itself, with its summary at the same place.
bool HasEachStroke(const StrokeHistory& history) {
  if (history.sample.size() != history.units.size() || history.parts.size() != 1) return false;
  for (std::size_t k = 0; k < history.units.size(); ++k)
    if (history.unit_parts[k].strokes() != 1 || history.unit_parts[k].first != history.sample[k].index)
      return false;
  return !InEpisodes(KindOf(history.machine));
}

/// `whole`, or what is so in odd strokes and what in the others, unless a swap says more of all (as in ExplainSamples).
Explanation ButForOdd(const StrokeHistory& history, Explanation whole) {
  const std::optional<EffectSwap> swap = whole.swap;
  if ((swap && swap->proven) || !HasEachStroke(history)) return whole;
  auto parted = ButForOddUnits(history, whole);
  if (!parted || parted->odd_strokes.empty()) return whole;
  parted->noise_scale = whole.noise_scale;
  parted->evidence_scale = whole.evidence_scale;
  DoubtWhatIsNotStored(history.machine, *parted);
  const bool in_doubt = parted->verdict == Verdict::kUnknown || parted->partial;
  return swap && swap->explains && in_doubt ? whole : *std::move(parted);
}

Result<ExplainResult> ExplainStoredUnits(const StrokeHistory& history, const ExplainOptions& options,
                                         bool but_for_odd) {
  ExplainOptions own = OptionsForEquations(options, history.equations());
  own.start = history.machine.added_effects;
  auto out = ExplainUnits(history, own);
  if (!out) return out;
  Explanation& x = out->explanation;
  DoubtWhatIsNotStored(history.machine, x);
  if (x.no_verdict.empty())
    x.swap = BestSwap(own, x, [&](const std::string& id) { return ExplainWithout(id, history, own); });
  if (but_for_odd) {
    x = ButForOdd(history, std::move(x));
    if (!x.odd_strokes.empty())
      out->base = FiguresOf(*x.model, x.base, static_cast<int>(history.units.size()));
  }
  TakeConfoundings(history.units, *out);
  if (!x.no_verdict.empty()) return out;
  SayWhatALogWouldTell(history, x);
  RefuseVerdict(WhyEpisodesDoNotTell(*out), x);
  TakeFloors(history, *out);
  return out;
}

}  // namespace

Result<ExplainResult> ExplainHistory(const StrokeHistory& history, const ExplainOptions& options) {
  return ExplainStoredUnits(history, options, false);
}

Result<ExplainResult> ExplainHistoryButForOdd(const StrokeHistory& history) {
  return ExplainStoredUnits(history, {}, true);
}

}  // namespace hydroscope
