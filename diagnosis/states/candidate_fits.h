#pragma once

#include <optional>
#include <string>
#include <vector>

#include "diagnosis/states/explain_states.h"
#include "diagnosis/states/spread_pieces.h"

namespace hydroscope {

/// A set of effects before it is fitted.
struct StateContender {
  std::vector<std::string> added;
  std::shared_ptr<const StateModel> model;
  std::vector<StateStart> starts;      ///< best first
  EffectSeen seen = EffectSeen::kYes;  ///< the last effect, in these episodes
  double foreseen = 0;  ///< energy left by linearisation, over the base's noise; 0: nothing is known of it
};

/// Fits a machine's model with effects added to it, all with outputs over the same noise.
class CandidateFits {
 public:
  /// All must outlive this; `base` is what gains are counted against. `starts_on`: the episodes that starts are tried on.
  CandidateFits(const Machine& machine, std::span<const Episode> episodes,
                const std::vector<std::size_t>& starts_on, const ExplainStatesOptions& options,
                const StateCandidate& base)
      : machine_(machine),
        episodes_(episodes),
        starts_on_(starts_on),
        few_(Chosen(episodes, starts_on)),
        options_(options),
        base_(base),
        noise_(base.fit.noise) {}

  /// `added` beyond the effects of `near`, by linearisation about it. Error: no such model.
  Result<StateContender> Screened(const std::vector<std::string>& added, const StateCandidate& near) const;
  /// From all its starts.
  StateCandidate Fitted(const StateContender& contender) const;
  /// From what short segments give, of the contender's start and of the machine file's. What leads where another fit of the set
  /// ended (`known`, nullptr if there is none) is not fitted again.
  StateCandidate FittedFromSegments(const StateContender& contender, const StateCandidate* known) const;
  /// From where its law comes nearest to that of another set, if that is nearer than `apart`; else nothing is fitted.
  StateCandidate FittedNear(const StateContender& contender, const StateCandidate& other, double apart) const;
  /// A fitted set from starts all over the ranges, as the model without it.
  StateCandidate FittedFromAfar(const StateCandidate& fitted) const;
  /// With some of the effects of `fitted`, the fit beginning where that ended.
  StateCandidate Without(const StateCandidate& fitted, const std::vector<std::string>& rest) const;
  /// As foreseen, not fitted.
  StateCandidate Foreseen(const StateContender& contender) const;

 private:
  std::vector<std::string> WithAdded(const std::vector<std::string>& added) const;
  bool TriesOnFew() const { return few_.size() < episodes_.size(); }
  /// The best of some starts after a few iterations on few episodes; nothing if the model diverges from all of them.
  std::optional<StateStart> BestOf(const std::shared_ptr<const StateModel>& model,
                                   std::span<const StateStart> starts) const;
  StateCandidate Fit(const std::vector<std::string>& added, std::shared_ptr<const StateModel> model,
                     std::span<const StateStart> starts) const;

  const Machine& machine_;
  std::span<const Episode> episodes_;
  const std::vector<std::size_t>& starts_on_;
  std::vector<Episode> few_;
  const ExplainStatesOptions& options_;
  const StateCandidate& base_;
  Eigen::VectorXd noise_;
};

}  // namespace hydroscope
