#include "workbench/explain/explain_log.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "core/constants.h"
#include "core/contains.h"
#include "core/shell_word.h"
#include "core/short_number.h"
#include "core/told_error.h"
#include "models/counted_words.h"
#include "models/machine_kind.h"
#include "models/parameter_unit.h"
#include "pipeline/log_faults/usual_modulus.h"
#include "workbench/explain/headline.h"
#include "workbench/explain/untried_causes.h"

namespace hydroscope {
std::vector<UnmeasuredEffect> UnmeasuredEffects(const Machine& machine, const ModelStructure& model) {
  std::vector<UnmeasuredEffect> out;
  const MachineKind& kind = KindOf(machine);
  if (kind.effects == nullptr) return out;
  for (auto& effect : kind.effects(machine)) {
    UnmeasuredEffect entry{effect, {}};
    for (int channel : effect->channels)
      if (model.channel_source[channel] < 0) entry.missing.push_back(model.channel_names[channel]);
    if (!entry.missing.empty()) out.push_back(std::move(entry));
  }
  return out;
}

std::vector<UnmeasuredEffect> NotStoredEffects(const ModelStructure& model) {
  std::vector<UnmeasuredEffect> out;
  for (const auto& effect : model.sample_effects) {
    const auto same = [&](const auto& other) { return other->id == effect->id; };
    const bool measured = std::ranges::all_of(
        effect->channels, [&](int channel) { return model.channel_source[channel] >= 0; });
    if (measured && std::ranges::none_of(model.effects, same)) out.push_back({effect, {}});
  }
  return out;
}

namespace {

/// PredictabilityOptions::min_share: less counts as nothing.
constexpr double kLeastSeen = PredictabilityOptions{}.min_share;

/// Fits the model of the machine file; `model` then has the shapes of its effects.
Status TakeModelAsItIs(std::shared_ptr<const ModelStructure>& model, ExplainResult& result) {
  if (result.log.machine.added_effects.empty()) {
    result.base = TRY(FitFigures(result.log));
    return {};
  }
  auto fitted = TRY(FitMachineModel(result.log));
  model = fitted.structure;
  result.base = std::move(fitted.figures);
  return {};
}

/// A balance of the user's own rarely describes a machine down to the sensor noise, and its library holds
/// what its user thought of. So an explanation that takes four fifths of the model error away names its
/// effects; what is left is said.
constexpr double kOwnBalanceLeft = 0.2;

void DoubtWhatIsLeft(const ExplainOptions& options, Explanation& x) {
  const bool at_floor =
      x.final.excess_ratio <= options.floor_excess + options.left_share * std::max(0.0, x.base.excess_ratio);
  if (x.set.empty() || at_floor || x.partial) return;
  x.partial = true;
  x.doubt = Tell("of the model error's energy {:.1f} % is left, more than sensor noise",
                 "von der Energie des Modellfehlers bleiben {:.1f} %, mehr als das Sensorrauschen",
                 100 * x.final.excess_ratio / x.base.excess_ratio);
}

bool HasSamples(const LogStrokes& log, const ModelStructure& model, int channel) {
  const auto is_good = [&](const Stretch& s) {
    return std::any_of(s[channel], s[channel] + s.samples, [](double value) { return std::isfinite(value); });
  };
  return model.channel_source[channel] >= 0 &&
         std::ranges::any_of(log.stretches, [&](const StrokeStretches& stroke) {
           return std::ranges::any_of(stroke, is_good);
         });
}

/// A play, a lag or a delay of a signal that was stored at some rows only may be what the storage made of it.
void DoubtForStorage(const FloorTrust& floor, Explanation& x) {
  const auto stored = std::ranges::find_if(floor.signals, [](const SignalNoise& s) {
    return s.kind == NoiseKind::kInterpolated || s.kind == NoiseKind::kHeld;
  });
  if (x.partial || stored == floor.signals.end()) return;
  if (x.verdict == Verdict::kUnknown && x.doubt.empty()) x.doubt = stored->sentence;
  for (const auto& effect : x.model->effects) {
    if (!effect->correct || !Contains(x.set, effect->id)) continue;
    x.partial = true;
    x.doubt = Tell("{} was stored at some rows only: that alone looks like {}",
                   "{} wurde nur in manchen Zeilen gespeichert: das allein sieht aus wie {}", stored->name,
                   effect->id);
    return;
  }
}

/// A play or a zero of a signal that is smaller than the steps it is read in may be what rounding made.
void DoubtForResolution(const FloorTrust& floor, Explanation& x) {
  if (x.partial) return;
  for (const EffectEstimate& e : x.final.effects) {
    const Effect& effect = *x.model->effects[e.choice.effect];
    const bool in_steps = std::ranges::any_of(floor.signals, [&](const SignalNoise& s) {
      return s.kind == NoiseKind::kQuantised && s.unit == effect.unit && std::abs(e.size) < s.quantum;
    });
    if (!effect.correct || !in_steps || !Contains(x.set, effect.id)) continue;
    x.partial = true;
    x.doubt = Tell(
        "the signal it acts on is read in steps coarser than that: rounding alone may look like {}",
        "das Signal, auf das er wirkt, wird in gröberen Stufen gelesen: Runden allein kann aussehen wie {}",
        effect.id);
    return;
  }
}

/// What a valve itself does between its command and its spool is no delay of a signal.
void DoubtForEcho(const LogStrokes& log, Explanation& x) {
  if (x.set.empty() || log.echoes.empty()) return;
  const bool late = std::ranges::any_of(x.model->effects, [&](const auto& effect) {
    return effect->correct && effect->unit == "s" && Contains(x.set, effect->id);
  });
  if (!late) return;
  x.partial = true;
  x.doubt = log.echoes.front().Sentence();
}

/// Two signals late beside one another may as well be a third that comes early, as a command does in the place of its reading.
void DoubtForCommand(const LogStrokes& log, Explanation& x) {
  const auto is_late = [&](const std::string& id) {
    return std::ranges::any_of(x.model->effects, [&](const auto& effect) {
      return effect->id == id && effect->correct && effect->unit == "s";
    });
  };
  if (std::ranges::count_if(x.groups, [&](const auto& group) { return is_late(group.front()); }) < 2) return;
  for (const StandstillRule& rule : KindOf(log.machine).standstill) {
    const int signal = log.machine.SignalIndex(std::string(rule.signal));
    if (rule.command.empty() || signal < 0) continue;
    const SignalSpec& spec = log.machine.signals[static_cast<std::size_t>(signal)];
    x.partial = true;
    x.doubt = Tell(
        "{0} that comes early looks the same, as a command in the place of its reading does: see whether column {1} is measured",
        "ein {0}, das zu früh kommt, sieht genauso aus, etwa ein Befehl an Stelle der Messung: ist Spalte {1} gemessen?",
        spec.name, spec.column);
    return;
  }
}

}  // namespace

Told TooFewForVerdict(std::size_t strokes, const CountedWords& counted) {
  if (strokes >= kMinExplainStrokes) return {};
  return Tell(
      "{} inside the gate, expected at least {}: the error is judged on {} left out. Record longer, or see "
      "what the gate lets through with 'hydroscope check'",
      "{} im Gate, mindestens {} erwartet: der Fehler wird an ausgelassenen {} beurteilt. Länger aufzeichnen; "
      "was das Gate durchlässt, zeigt 'hydroscope check'",
      counted.CountedTold(strokes), kMinExplainStrokes, counted.SeveralDative());
}

void RefuseVerdict(const Told& why, Explanation& x) {
  if (why.empty()) return;
  x.warnings.insert(x.warnings.begin(), why);
  x.no_verdict = why;
  x.verdict = Verdict::kUnknown;
  x.set.clear();
  x.groups.clear();
  x.odd_strokes.clear();
  x.partial = x.may_be_noise = x.small_error = false;
  x.doubt = {};
}

void RefuseImpossibleParameters(const Machine& machine, std::size_t strokes, Explanation& x) {
  const MachineKind& kind = KindOf(machine);
  if (!x.no_verdict.empty()) return;
  const std::vector<Estimate> parameters = BaseParameters(*x.model, x.final, static_cast<int>(strokes));
  for (const Estimate& e : parameters)
    if (const Told impossible = ImpossibleFlow(kind, e);
        e.reason != EstimateReason::kOutsidePhysics && std::isfinite(e.value + e.std) && !impossible.empty())
      return RefuseVerdict(impossible, x);
  for (Told& unusual : UnusualParameters(machine, parameters)) x.warnings.push_back(std::move(unusual));
  if (x.verdict == Verdict::kUnknown) return;
  const auto wrong = std::ranges::find_if(parameters, [](const Estimate& e) {
    return e.reason == EstimateReason::kOutsidePhysics && std::abs(e.value) > kNormal95 * e.std;
  });
  if (wrong == parameters.end()) return;
  const DisplayUnit unit = ParameterUnit(kind, wrong->parameter, wrong->unit);
  const Told why = Tell(
      "{} comes out as {} {}, which physics forbids, however well the model fits: check units, signs, zeros and geometry "
      "in the machine file",
      "{} kommt als {} {} heraus, was die Physik verbietet, so gut das Modell auch passt: Einheiten, Vorzeichen, Nullpunkte und "
      "Geometrie in der Maschinendatei prüfen",
      wrong->parameter, ShortNumber(wrong->value * unit.factor + unit.offset), unit.name);
  if (x.verdict == Verdict::kAdequate) return RefuseVerdict(why, x);
  x.partial = true;
  x.doubt = why;
}

namespace {

/// Says what the noise is like where the floor does not rest on it, and what the verdict rests on instead.
void WarnOfFloor(const FloorTrust& trust, Explanation& x) {
  if (x.verdict == Verdict::kUnknown && !trust.may_be_noise.empty())
    x.warnings.push_back(Tell("{}, or it moves so: noise of that kind would be part of the error left",
                              "{}, oder es bewegt sich so: solches Rauschen wäre Teil des Restfehlers",
                              trust.may_be_noise));
  x.warnings.insert(x.warnings.end(), trust.sentences.begin(), trust.sentences.end());
  if (trust.stated)
    x.warnings.push_back(Tell("the noise floor is taken from the noise that the machine file states",
                              "als Rauschgrenze gilt das Rauschen, das die Maschinendatei angibt"));
  else if (!trust.believable && x.final_left.tested)
    x.warnings.push_back(Tell(
        "the noise floor is taken from what no function of the signals predicts; a law that explains "
        "less than {:.0f} % of the error left would not be seen",
        "als Rauschgrenze gilt, was keine Funktion der Signale voraussagt; ein Gesetz, das weniger als {:.0f} % des "
        "Restfehlers erklärt, bliebe ungesehen",
        std::ceil(100 * std::max(x.final_left.null_share, kLeastSeen))));
}

}  // namespace

Told WhyUnmeasured(const UnmeasuredEffect& unmeasured) {
  if (unmeasured.missing.empty())
    return Tell("it is tried on a log only: stored strokes keep no columns of it",
                "er wird nur an einer Aufzeichnung versucht: gespeicherte Hübe behalten keine Spalten davon");
  return Tell("the machine file has no signal {}", "die Maschinendatei hat kein Signal {}",
              fmt::to_string(fmt::join(unmeasured.missing, ", ")));
}

bool HasFloorOfItsOwn(const LogTrust& trust, const Explanation& explanation) {
  return !trust.floor.believable || explanation.noise_scale != 1;
}

JudgedModel JudgeAsExplain(const LogStrokes& log, std::shared_ptr<const ModelStructure> model,
                           GramFit& figures, const ExplainOptions& options) {
  const bool own_balance = model->kind->own_library;
  JudgedModel out;
  out.trust = JudgeLog(log, figures.theta, figures.noise_floor);
  const FloorTrust& floor = out.trust.floor;
  ExplainOptions as_is = options;
  as_is.start = log.machine.added_effects;
  if (own_balance) as_is.left_share = std::max(as_is.left_share, kOwnBalanceLeft);
  as_is.floor_believable = floor.believable || floor.stated;
  as_is.noise_is_white = floor.believable || floor.only_moves;
  if (floor.stated) as_is.noise_scale = floor.noise_scale;
  out.explanation = ExplainSamples(std::move(model), log.stretches, log.window, as_is);
  const Explanation& x = out.explanation;
  if (!x.base.solved) return out;
  WarnOfFloor(floor, out.explanation);
  out.explanation.warnings.insert(out.explanation.warnings.end(), log.doubts.begin(), log.doubts.end());
  if (own_balance) DoubtWhatIsLeft(options, out.explanation);
  DoubtForUntried(
      log.machine, [&](int channel) { return HasSamples(log, *x.model, channel); }, out.explanation);
  DoubtForStorage(floor, out.explanation);
  DoubtForResolution(floor, out.explanation);
  DoubtForCommand(log, out.explanation);
  DoubtForEcho(log, out.explanation);
  // Odd strokes are no part of the model's base; a floor that is not white is what explain makes of it.
  if (!x.odd_strokes.empty()) figures = FiguresOf(*x.model, x.base, figures.strokes);
  // What the model lacks may pass for less noise than there is: the best model found tells it.
  if (HasFloorOfItsOwn(out.trust, x)) figures.noise_floor = x.final.noise_floor;
  // Rows too far apart: what they miss looks like an effect, or hides one.
  RefuseVerdict(!log.swapped.empty()         ? log.swapped.front()
                : out.trust.rate.fast_enough ? ImpossibleFigures(figures)
                                             : out.trust.rate.sentence,
                out.explanation);
  RefuseImpossibleParameters(log.machine, log.stretches.size(), out.explanation);
  return out;
}

NoiseScales NoiseScalesOf(const LogStrokes& strokes, const LogTrust& trust) {
  if (trust.floor.believable) return {};
  const auto explained = ExplainStrokes(strokes);
  if (!explained || !explained->explanation.base.solved) return {};
  const Explanation& x = explained->explanation;
  NoiseScales out{x.noise_scale, x.evidence_scale, {}};
  if (const auto white = FitFigures(strokes); white && white->noise_floor > 0)
    out.floor = std::pow(x.final.noise_floor / white->noise_floor, 2);
  return out;
}

double TrustedFloor(const LogStrokes& log, const MachineModel& model) {
  GramFit figures = model.figures;
  if (!model.trust.floor.believable) JudgeAsExplain(log, model.structure, figures);
  return figures.noise_floor;
}

Result<ExplainResult> ExplainStrokes(LogStrokes strokes, const ExplainOptions& options) {
  ExplainResult out;
  out.log = std::move(strokes);
  out.strokes = out.log.stretches.size();
  if (const Told few = TooFewForVerdict(out.strokes, CountedWordsOf(out.log.machine)); !few.empty())
    return BadInput(few);
  std::shared_ptr<const ModelStructure> model = out.log.model;
  TRY(TakeModelAsItIs(model, out));
  JudgedModel judged = JudgeAsExplain(out.log, model, out.base, options);
  out.explanation = std::move(judged.explanation);
  out.trust = std::move(judged.trust);
  if (!out.explanation.base.solved) return BadInput(WhyNotSolved(*model, out.log));
  out.unmeasured = UnmeasuredEffects(out.log.machine, *model);
  TakeConfoundings(out.log.Grams(), out);
  const auto residuals_of = [&](const ExtendedFit& fit) {
    Residuals residuals = ResidualsOf(out.explanation.model, out.log.stretches, out.log.window,
                                      ColumnWeights(*out.explanation.model, fit));
    if (HasFloorOfItsOwn(out.trust, out.explanation)) ScaleNoise(fit.noise_floor, residuals);
    return residuals;
  };
  Residuals residuals = residuals_of(out.explanation.base);
  out.location = Locate(residuals);
  out.signals = std::move(residuals.signals);
  if (out.explanation.verdict == Verdict::kUnknown)
    out.remainder = ShapeOfRemainder(residuals_of(out.explanation.final));
  if (out.explanation.verdict != Verdict::kAmbiguous) return out;
  if (model->kind->own_library)
    out.signal_experiment =
        ProposeSignalExperiment(out.explanation, out.log.machine, out.log.stretches, out.log.window);
  else
    out.experiment = ProposeExperiment(out.explanation, out.log.machine, out.log.stretches, out.log.window);
  return out;
}

namespace {

std::vector<ConditionRange> RangesOfLog(const LogStrokes& log) {
  std::vector<ConditionRange> ranges;
  for (const StrokeRecord& stroke : log.strokes) IncludeStroke(log.model->conditions, stroke.summary, ranges);
  return ranges;
}

}  // namespace

std::vector<Confounding> ConfoundingsOf(const LogStrokes& log, const std::vector<std::string>& added,
                                        std::span<const Estimate> parameters) {
  return ConfoundingsOf(added, log.model, log.Grams(), log.window, RangesOfLog(log), parameters);
}

void TakeConfoundings(std::span<const StrokeGram> grams, ExplainResult& result) {
  const Explanation& x = result.explanation;
  const std::vector<ConditionRange> ranges = RangesOfLog(result.log);
  const auto of = [&](const ExtendedFit& fit, std::span<const Estimate> parameters) {
    std::vector<std::string> added;
    for (const EffectEstimate& e : fit.effects) added.push_back(result.effect(e.choice.effect).id);
    return ConfoundingsOf(added, result.log.model, grams, result.log.window, ranges, parameters);
  };
  result.confounded = of(x.base, result.base.parameters);
  MarkConfounded(result.confounded, result.base.parameters);
  result.extended_confounded = x.final.effects.size() == x.base.effects.size()
                                   ? result.confounded
                                   : of(x.final, result.ExtendedParameters());
}

std::vector<Estimate> ExplainResult::ExtendedParameters() const {
  std::vector<Estimate> out = BaseParameters(*log.model, explanation.final, static_cast<int>(strokes));
  MarkConfounded(extended_confounded, out);
  const bool as_it_is = explanation.final.effects.size() == explanation.base.effects.size();
  for (std::size_t i = 0; as_it_is && i < out.size(); ++i)
    if (out[i].reason == EstimateReason::kUpdated) out[i].reason = base.parameters[i].reason;
  return out;
}

const Effect* ExplainResult::FindEffect(const std::string& id) const {
  for (const auto& effect : explanation.model->effects)
    if (effect->id == id) return effect.get();
  return nullptr;
}

Result<ExplainResult> ExplainLogs(const std::vector<std::string>& logs, const std::string& machine_file,
                                  const ExplainOptions& options) {
  const auto machine = TRY(LoadMachine(machine_file));
  auto strokes = TRY(ReadStrokes(logs, machine, KeepSamples::kYes));
  auto out = ExplainStrokes(std::move(strokes), options);
  if (!out && !out.error().text.starts_with(logs.front() + ": "))
    return tl::unexpected(Error{out.error().kind,
                                fmt::format("{}: {}", fmt::join(logs, ", "), out.error().text),
                                out.error().german});
  if (!out) return out;
  out->target = "--machine " + ShellWord(machine_file);
  return out;
}

}  // namespace hydroscope
