#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "diagnosis/explain.h"

namespace hydroscope {

/// A model under construction: effects chosen so far and their fit.
struct CandidateModel {
  std::vector<EffectChoice> choices;
  ExtendedFit fit;
};

/// The model as it is: base balance and the effects it has already, each in its best shape. Not solved if one
/// of them cannot be fitted or is not in the library.
CandidateModel StartModel(const StrokeSet& strokes, const std::vector<std::string>& ids);

/// Effects of a library that strokes can hardly tell from this one (Effect::twins, of either).
std::vector<std::string> TwinsOf(const ModelStructure& model, std::string_view id);
/// What two effects are to one another, nullptr if they are no twins.
const Effect::Twin* FindTwin(const ModelStructure& model, std::string_view a, std::string_view b);

/// Whether one of two effects is told to be easily taken for the other (Effect::confused_with, of either).
bool AreConfused(const Effect& a, const Effect& b);
/// Nonlinear parameters that a law leaves to the data.
std::size_t FreeNumbers(const Effect& effect);
/// One of these that the data put at a limit of what it may be (`limit_share`: of its range), nullptr if there is none: they would
/// rather have another law.
const NonlinearParameter* NumberAtItsLimit(const ModelStructure& model, const EffectChoice& choice,
                                           double limit_share);

/// The effects of a group that may be the one (Explanation::groups), those together that leave the very same error on every stroke: no
/// stroke like these tells them apart, so they are one answer. Each in the order of the group.
std::vector<std::vector<std::string>> ClassesOf(const Explanation& explanation,
                                                const std::vector<std::string>& group);

/// Stroke by stroke, held out: by how much `a` errs more than `b`, over the strokes that both were fitted to.
/// Integral form, noise taken out, or flow form, as shown.
Eigen::VectorXd Worse(const ExtendedFit& a, const ExtendedFit& b);
Eigen::VectorXd WorseInFlow(const ExtendedFit& a, const ExtendedFit& b);

class EffectRanking;
/// An explanation with what stands before any effect is chosen: the model as it is and the ranking on it, which is empty if
/// that model is not solved.
Explanation BeginExplanation(const StrokeSet& strokes, const ExplainOptions& options,
                             const CandidateModel& start, const EffectRanking& ranking);

/// Tries effects on top of a model and weighs the evidence for them.
class EffectRanking {
 public:
  /// `noise_variance` of one equation is the unit of all gains. Both references must outlive the ranking.
  EffectRanking(const StrokeSet& strokes, const ExplainOptions& options, double noise_variance)
      : strokes_(strokes), options_(options), noise_(noise_variance) {}

  /// Every named effect that is not in `on` yet, best first; those that cannot be fitted come last.
  std::vector<RankedEffect> Rank(const CandidateModel& on) const;
  /// Generic laws on top of `on` (ModelStructure::generic_laws), best first.
  std::vector<RankedEffect> RankGeneric(const CandidateModel& on) const;
  /// Held-out error energy removed, in noise variances, less the price of free nonlinear parameters.
  double Gain(const ExtendedFit& from, const ExtendedFit& to) const;
  /// Whether `candidate` explains about as well as `best`, which gained `gain`: a model confidence set by paired
  /// stroke-wise losses.
  bool IsRival(const ExtendedFit& candidate, const ExtendedFit& best, double gain) const;
  /// An effect alone or in place of one of two, and what it gains there.
  struct Contender {
    int effect = 0;
    const ExtendedFit* fit = nullptr;
    double gain = 0;
  };
  /// Whether an effect stays in the set beside the best one: as good a rival where what a further law might still put right has
  /// gained `gain`, its twin, or the same law with fewer free numbers. The one rule, for effects alone and for those of pairs.
  bool StaysBeside(const Contender& candidate, const Contender& best, double gain) const;
  /// Effects of the ranking on top of `on` that stand out, or are twins of the first one, and stay beside it, itself included.
  /// `complete`: the first leaves nothing to a further law, which would tell that its own is not quite right.
  std::vector<std::string> Rivals(const CandidateModel& on, const std::vector<RankedEffect>& ranking,
                                  bool complete) const;
  /// Where another law would explain as much, the first of the ranking is not quite the law, and what decides between it and others
  /// must be more than a further law may gain: the effects of `set` and those that leave no more than noise may and fall behind by
  /// less, best first.
  std::vector<std::string> RivalsInDoubt(const std::vector<RankedEffect>& ranking,
                                         const std::vector<std::string>& set) const;
  /// Of a law that grows with the oil's temperature, effect `at` of `model`: the same law without that (a leak, of one that does), if
  /// with another law of the temperature beside it explains about as well: that it grows is not proven.
  std::vector<std::string> SteadyBesideAnother(const CandidateModel& model, std::size_t at) const;
  /// ExplainOptions::measured says that the effect is there / of another size than this.
  bool IsConfirmed(int effect) const;
  bool IsRefuted(const EffectEstimate& estimate) const;
  /// Strong enough to stand as one of two effects.
  bool IsStrong(const EffectEstimate& estimate) const;
  /// By how much sizes of further laws scatter more between strokes than the noise of single equations promises, squared: the
  /// median over all laws on top of `on`. 1: equations are as good as independent.
  double DesignEffect(const CandidateModel& on) const;
  CandidateModel With(const CandidateModel& on, const EffectChoice& choice) const;

 private:
  /// An effect that is the same to first order as another one, and about as good (Effect::twins).
  bool IsTwin(const Contender& candidate, const Contender& best) const;
  /// An admissible fit with `ranked` in a shape of its grid takes the place of one that gains less.
  void TakeIfBetter(const CandidateModel& on, ExtendedFit fit, int shape, RankedEffect& ranked) const;
  /// Takes out laws whose twin would have to explain as much and does not (Effect::Twin::least).
  void RefuteByTwins(std::vector<RankedEffect>& ranking) const;
  /// A law within its limits: as ranked, or where the data put it at one of them, in the best shape that is not there.
  bool StaysWithinItsLimits(const CandidateModel& on, const RankedEffect& candidate, const RankedEffect& best,
                            double gain) const;
  /// A twin that explains about as much and misses the limits of what stands out, which the best one just keeps.
  bool IsWeakTwin(const RankedEffect& candidate, const RankedEffect& best, double gain) const;
  /// Effect number `effect` of the library on top of a model.
  RankedEffect Try(const CandidateModel& on, int effect) const;
  /// How an effect was tried, in any of its shapes.
  struct Tried {
    bool separable;  ///< it is told from the model
    bool forbidden;  ///< with a size that physics forbids
    bool excited;    ///< a size that matters would stand out if noise were all that the model leaves
  };
  /// Why these strokes cannot test an effect.
  Told WhyNot(const RankedEffect& ranked, const Tried& tried) const;
  void PreferStored(std::vector<RankedEffect>& ranking) const;
  void PreferMeasured(std::vector<RankedEffect>& ranking) const;
  double Cost(const ExtendedFit& fit) const;

  const StrokeSet& strokes_;
  const ExplainOptions& options_;
  double noise_;
};

}  // namespace hydroscope
