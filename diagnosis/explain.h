#pragma once

#include <algorithm>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/told.h"
#include "diagnosis/extended_fit.h"
#include "diagnosis/remainder/predictability.h"
#include "estimation/floor_trust.h"
#include "models/stretch.h"

namespace hydroscope {

/// What the data say of the model. Never a bare ranking.
enum class Verdict {
  kAdequate,   ///< nothing significant above the noise floor
  kNamed,      ///< one effect (or one of each hidden at once) explains the error
  kAmbiguous,  ///< several effects explain it equally well
  kUnknown,    ///< an error is there and no known effect explains it
};
const char* VerdictName(Verdict verdict);

/// Size of an effect as a test off the log gave it, SI: 0 +- std says that it is not there.
struct MeasuredSize {
  double size = 0, std = 0;
};

/// Thresholds, calibrated by `hydroscope benchmark hidden-effects` on simulated machines (docs/workbench.md).
struct ExplainOptions {
  double min_gain = 40.0;  ///< held-out error energy an effect must remove, in units of the noise variance
  double min_t = 4.0;      ///< size over its stroke-clustered standard error
  double floor_excess = kFloorExcess;
  double doubt_excess = 0.12;  ///< ... and above which the explanation is flagged as partial
  double left_share = 0.005;   ///< ... plus this share of the base model's excess
  /// Share of the base model's excess that may be left above doubt_excess, for what was found to be a name at all: more stays than
  /// it takes away.
  double most_left = 0.5;
  /// Error over output, both rms, below which nothing is missing, however sure the error is: between rows signals do not quite move
  /// evenly. With 0 healthy presses whose controller is as slow as the rows have no verdict, with twice this tests miss effects.
  double trifle = 0.0005;
  /// What removing as much gains, which Explain finds; an effect that gains less is named if it moves a parameter (biased).
  double trifle_gain = 0;
  /// Gain another law may still make on an explanation that claims to be complete.
  double max_remainder = 40.0;
  double doubt_remainder = 15.0;   ///< ... and above which the explanation is flagged as partial
  double remainder_share = 0.003;  ///< of the gain so far, allowed on top of the former
  double doubt_share = 0.0005;     ///< ... and of the latter
  double doubt_margin = 20.0;      ///< a law without a name within this of the best flags it as partial too
  double beaten_margin = 15.0;     ///< ... and one better than the best by this leaves no name
  /// Two effects act on one another, which their sum leaves out: so much more may be left.
  double interplay = 4.0;
  /// As min_t, for each effect of a pair: a wrong first one leaves scraps for a second.
  double second_t = 6.0;
  /// Taken off the gain per nonlinear parameter: freedom to fit is not evidence.
  double nonlinear_cost = 12.0;
  double rival_gain = 12.0;  ///< rivals within this of the best, in noise variances, stay in the set
  double rival_t = 2.5;  ///< ... and those whose stroke-wise loss is not worse by this many standard errors
  /// Gain beyond which a law whose size may be zero, its shape free, is no all-clear.
  double most_by_shape = 200.0;
  double sure_gain = 60.0;  ///< ... but none worse by so many noise variances, and by more than MayRemain
  int max_effects = 2;      ///< effects hidden at once that are looked for
  bool try_swaps = true;    ///< ExplainSamples: whether an effect of `start` was added wrongly
  /// Ids of effects that are part of the model already; each in its best shape.
  std::vector<std::string> start;
  std::map<std::string, Told> untestable;  ///< ids that these strokes cannot test, and why
  std::vector<std::string> exclude;        ///< ids left out of the library, for tests of what is not known
  /// Sizes of effects known from a test off the log (Effect::measured_by).
  std::map<std::string, MeasuredSize> measured;
  /// The noise shares of the Grams hold (estimation/signal_noise.h). Where they do not, the floor is what no
  /// function of the measured signals can predict on strokes left out (diagnosis/remainder/predictability.h).
  bool floor_believable = true;
  /// Whatever there is of sensor noise is white: what a model leaves must be independent from block to block
  /// (diagnosis/remainder/whiteness.h), wherever the floor is taken from.
  bool noise_is_white = true;
  PredictabilityOptions predictability;
  // Thresholds of single steps, set on the same campaigns unless said otherwise.
  /// An effect this many times its typical size must stand out, else it cannot be tested.
  double matters_times = 5.0;
  /// Share of the noise energy by which the floor may be off (estimation/noise_floor_test.cc).
  double floor_error = 0.04;
  std::size_t pair_firsts = 5;  ///< first effects on top of which every second one is tried
  double close_gain = 0.1;      ///< effects that gain this share of the best are refined
  double first_look_t = 3.0;    ///< second_t before shapes are refined, which makes sizes surer
  /// Share of an effect that must be sure beside another that is easily taken for it, else a third of it may be that.
  double sure_share = 2.0 / 3;
  /// A generic law of which less than this share is left beside a named effect is much the same as that effect. Leaks to
  /// sides of different pressure are much the same too, and yet different causes: such a flow must be the very same.
  double same_law = 0.02, same_flow = 1e-4;
  /// Share of the difference that an effect must make beside another to be sure of it: laws that are nearly right leave that
  /// much (kinds "relative" of `hydroscope benchmark plant-logs`).
  double small_second = 0.03;
  /// Noise energy over the floor up to which noise that is but slightly coloured may pass for white: its test has a tolerance
  /// (SignalNoiseOptions), which a block of ten rows multiplies.
  double hidden_colour = 2.0;
  /// ... and up to which an error that nothing predicts may be noise at all: AR(1) noise of 0.97 that is nine tenths of what
  /// rows show raises the contrast over four rows by less than its test sees, and the energy of blocks of ten rows ninefold.
  double any_colour = 10.0;
  /// Share and p-value of what can be predicted below which it is nothing.
  double nothing_share = 0.02, nothing_p = 0.05;
  /// Predictability::correlation, and EffectRanking::DesignEffect, of white sensor noise, for which the thresholds were
  /// calibrated: pressure noise in the valve's flow is integrated and makes neighbouring equations alike (median of healthy
  /// logs of `hydroscope benchmark hidden-effects`).
  double white_correlation = 2.0;
  double noise_scale = 1;  ///< noise energy over that of the noise shares
  /// Noise variances that count as one, at least: where neighbouring equations are alike, each tells less (design effect,
  /// Kish 1965; of a likelihood ratio, Rao and Scott 1984). Explain finds how many (EffectRanking::DesignEffect).
  double evidence_scale = 1;
  /// Growth of that number which another search is worth: strokes by the dozen tell it to a third.
  double evidence_growth = 0.5;
  /// Standard errors of the model error's energy above floor_excess up to which it may still be noise alone.
  double floor_errors = 2;
  /// Effects that are functions of one and the same signal: as many draw any curve over it, also that of one law which nobody
  /// thought of when the machine file was written.
  std::size_t any_curve = 3;
  /// Laws without a name that are proposed, at most: more would say no more than that the log tells none of them.
  std::size_t most_proposed = 5;
  /// p-value that an effect needs where the model as it is leaves no more than noise: some thirty effects in several shapes
  /// each are tried, which together find one in a hundred such logs (Bonferroni).
  double chance_at_floor = 1e-4;
  /// p-value below which a law beside nothing else is no chance: of a hundred that are tried one in ten thousand logs (Bonferroni).
  double sure_of_more = 1e-6;
  /// Noise that would leave so many times as much as the model as it is leaves on one half of the strokes, fitted by itself, is
  /// not believable: what bends a fit also bends the noise it lets through.
  double noise_of_half = 2;
  /// Share of DerivedParameter::useful_std by which an effect too small for a name may move a parameter without a word: a tenth
  /// of the value, of one without a unit 0.017.
  double biased = 1.0 / 3;
  /// p-value below which an effect that gains min_gain may not move one out of its interval either: few strokes make no small ones.
  double bias_p = 0.05;
  /// Rows by which a spool may seem late, without a doubt, for the flow between two rows is taken to be the mean of both: 0 to 0.1
  /// for a valve of 60 to 150 Hz, damped by 0.6 to 1, whose command is held for 4 ms (its response integrated).
  double integrated_rows = 0.15;
  /// Share of its range by which a value that the data chose is away from its limits, if it is no doubt of the law.
  double limit_share = 0.02;

  /// What a law must gain that moves no parameter.
  double LeastGain() const { return std::max(min_gain, trifle_gain); }
  /// Whether the model of this fit leaves no more than noise may.
  bool IsDownToNoise(const ExtendedFit& fit) const {
    return fit.excess_ratio <= floor_excess + floor_errors * fit.excess_error;
  }
  /// What a further law may gain on an explanation that claims to be complete and has gained `gain`, in noise variances;
  /// `times` the share that is allowed one effect. Whatever decides between two explanations must be more than that.
  double MayRemain(double gain, double times = 1) const {
    return max_remainder + times * remainder_share * gain;
  }
};

/// One effect tried on top of a model.
struct RankedEffect {
  int effect = 0;  ///< index into ModelStructure::effects
  std::string id;
  std::vector<double> nonlinear;  ///< values of the effect's nonlinear parameters, SI
  bool testable = false;
  Told why_not;             ///< why it cannot be tested with these data
  bool stands_out = false;  ///< of the noise, in the integral form: enough for a rival of what is named
  /// ... and it lowers the error on strokes left out in the units shown: may be named.
  bool significant = false;
  /// false: refined, its one parameter contradicts itself (Effect::implied); or it contradicts what was measured of it.
  bool lawful = true;
  double gain = 0;     ///< held-out error energy removed, in noise variances
  double p_value = 1;  ///< of the size against 0, clustered by stroke
  ExtendedFit fit;
};

struct ExplainStep {
  std::string added;       ///< "" for the model as it is
  double rms_holdout = 0;  ///< output unit
  double excess_ratio = 0;
};

/// Strokes that differ from the rest of a log.
struct OddStrokes {
  std::vector<std::size_t> strokes;  ///< indices of the strokes explained
  std::vector<std::string> set;      ///< what explains them against the rest, best first; [] if nothing does
  /// Of the base model: with another value in them, or one of its own in each, it explains them as well; then `set` is [].
  std::string parameter = {};
  Told doubt = {};  ///< why `set` is not proven, if so
};

/// A model that does better than the one as it is by giving up an effect that was added to it.
struct EffectSwap {
  std::string out;              ///< effect of ExplainOptions::start to take out
  std::vector<std::string> in;  ///< effects to add in its place; [] = none is needed
  double rms_before = 0;        ///< error on strokes left out as it is, output unit
  double rms_after = 0;         ///< ... and with the swap
  bool explains = false;        ///< what comes in brings the error to the floor ...
  bool proven = false;          ///< ... and nothing speaks against it
};

/// A law of general shape that no effect of the machine file has, and that explains the error as far as one does.
struct ProposedLaw {
  std::string expression;  ///< as an effect of the machine file would have it
  /// Whose rate it is: a signal that comes late, or through a filter, leaves such an error; "" else.
  std::string late_signal;
  double rms_holdout = 0;  ///< output unit
  double excess_ratio = 0;
};

struct Explanation {
  std::shared_ptr<const ModelStructure> model;  ///< has the shapes that every EffectChoice below names
  Verdict verdict = Verdict::kUnknown;
  std::vector<std::string> set;                  ///< best first, [] if adequate or unknown
  std::vector<std::vector<std::string>> groups;  ///< per hidden effect, those that may be it, best first
  /// With `unknown`: an effect explains part of the error. With a set: the data do not prove that it is one
  /// of the set, `doubt` says why.
  bool partial = false;
  /// With `unknown`: nothing explains a part of what is left, and nothing predicts it: noise that is not white, or a law that no
  /// function of the signals shows. `doubt` says so.
  bool may_be_noise = false;
  /// With `unknown`: what is left is near the noise, and too little for a name. `doubt` says why it matters.
  bool small_error = false;
  /// With `unknown`: `margin_law`, a law without a name, describes the strokes down to the floor, and what was found does not.
  bool nameless = false;
  /// With `unknown`, of a machine of the user's own: laws that each leave no more than a name may leave, best first.
  std::vector<ProposedLaw> proposed;
  Told doubt;
  /// Signals that are not measured, without which a cause much like one of `set` could not be tried.
  std::vector<std::string> unmeasured;
  /// Causes much like one of `set` that could not be tried: they may be it as well.
  std::vector<std::string> untried;
  /// Error energy per equation, integrated output unit squared, that ExplainOptions::trifle comes to.
  double trifle = 0;
  Told no_verdict;  ///< with `unknown`: why these strokes carry no verdict at all, a sentence; "" if they do
  std::vector<Told> warnings;  ///< what makes the result doubtful, a sentence each, for every output
  double remainder = 0;  ///< largest gain of a further law on `final`, named or generic, in noise variances
  std::string remainder_law;
  double margin = 0;       ///< by which what was found beats the best generic law that is not much the same
  std::string margin_law;  ///< "" if none was tried
  ExtendedFit base;        ///< the model as it is: base balance and ExplainOptions::start
  ExtendedFit final;       ///< with the effects found
  int started = 0;         ///< effects of `base`, the first of `chosen`
  std::vector<EffectChoice> chosen;   ///< effects of `final`, those of `base` first
  std::vector<RankedEffect> ranking;  ///< on the model as it is, best first
  std::vector<RankedEffect> second;   ///< on the model and the first effect, best first
  std::vector<ExplainStep> steps;
  double noise_scale = 1;     ///< ExplainOptions::noise_scale that was found
  double evidence_scale = 1;  ///< largest ExplainOptions::evidence_scale that the effects stand in
  /// Strokes that were left out of everything else here, except of a set that explains them.
  std::vector<OddStrokes> odd_strokes;
  Predictability base_left, final_left;  ///< of the error of `base` and `final`; tested on samples only
  std::map<std::string, MeasuredSize> measured;  ///< ExplainOptions::measured
  std::optional<EffectSwap> swap;                ///< an effect that was added wrongly, and what does better
};

/// Finds which effects of the library explain what the model leaves, from Grams alone. `base.solved` is
/// false, and the rest empty, if the strokes cannot separate the parameters of the model as it is; ids of
/// `start` must be in the library. Chain: score on held-out strokes, significance by stroke, rivals (model
/// confidence set after Hansen, Lunde, Nason 2011, by paired stroke-wise losses), adequacy gate against the
/// noise floor, remainder for any further law, and whether a law without a name would do as well. On a
/// machine of the user's own all subsets of the library are compared instead
/// (diagnosis/explain_own_machine.h). What does not lower the error on strokes left out, in the units shown,
/// is not named.
Explanation Explain(const StrokeSet& strokes, const ExplainOptions& options = {});

/// The same with the samples at hand: thresholds, widths and exponents of the effects that come close are
/// refined on the samples before the verdict, and generic laws (ModelStructure::generic_laws) stand against the
/// named effects. Where the model as it is has effects and one of them may be wrong, it is taken out and the
/// rest explained again (Explanation::swap).
Explanation ExplainSamples(std::shared_ptr<const ModelStructure> model,
                           std::span<const StrokeStretches> strokes, const WindowSamples& window,
                           const ExplainOptions& options = {});

}  // namespace hydroscope
