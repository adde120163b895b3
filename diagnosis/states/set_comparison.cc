#include "diagnosis/states/set_comparison.h"

#include <algorithm>

namespace hydroscope {

bool SetComparison::Better(const StateCandidate& now, const StateRemainder& left,
                           const StateCandidate& next) const {
  const auto [removed, t] = PairedGain(now.fit.HeldOutEnergies(), next.fit.HeldOutEnergies());
  // An effect that acts in a few pieces has a small t however large its gain is against correlated noise.
  const bool large = removed > options_.min_gain * EvidenceOf(next) && t > options_.few_t &&
                     removed > options_.min_removed * now.held_out;
  if (!left.structured)
    return large || (removed > options_.min_gain * EvidenceOf(next) && t > options_.sure_t);
  const double predictable = now.held_out * left.least_share;
  return removed > options_.min_removed * predictable && removed > options_.rival_gain * EvidenceOf(next) &&
         (large || t > options_.min_t);
}

bool SetComparison::HardlyWorse(const std::vector<double>& other, const std::vector<double>& best,
                                double removed, double noise) const {
  const auto [worse, t] = PairedGain(other, best);
  const bool near = worse < options_.rival_gain * noise || t < options_.rival_t;
  return near && worse < std::max(options_.rival_gain * noise, options_.rival_share * removed);
}

bool SetComparison::NearlyAsGood(const StateCandidate& other, const StateCandidate& best,
                                 double removed) const {
  return HardlyWorse(other.fit.HeldOutEnergies(), best.fit.HeldOutEnergies(), removed, EvidenceOf(best));
}

double SetComparison::LeftShare(const StateCandidate& set) const {
  const auto effects = static_cast<double>(set.added.size());
  return options_.left_share / (effects * effects);
}

}  // namespace hydroscope
