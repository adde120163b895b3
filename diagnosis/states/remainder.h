#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "diagnosis/states/other_causes/error_bursts.h"
#include "estimation/states/fit.h"

namespace hydroscope {

/// What they find on machines that miss nothing, and miss of laws that no effect of the file is, `hydroscope benchmark
/// state-machines` counts.
struct StateRemainderOptions {
  int flips = 199;      ///< of the signs of the pieces: the share that chance reaches
  double max_p = 0.02;  ///< beyond: what is left is noise for all that can be seen
  /// Of the error's energy: less is not worth a law (as in diagnosis/remainder/predictability.h).
  double min_share = 0.03;
  /// Beyond max_p, up to which p-value a share of this may still be a law that the log shows too seldom.
  double doubt_p = 0.2, doubt_share = 0.1;
  /// Share that chance reaches in one of twenty logs, from which on a log tells too little of what is left for an all-clear.
  double powerless = 0.3;
  ErrorBurstsOptions bursts;
  int fourier = 12;  ///< random cosines of all states and inputs together
  std::uint32_t seed = 7;
};

/// What functions of states and inputs could predict of what a fit leaves, on pieces of the log left out.
struct StateRemainder {
  /// Of the error's energy on groups of pieces left out, with the parameters fitted to the others.
  double share = 0;
  double energy = 1;  ///< of the error on groups left out with the functions, of the fit's: noise has no more
  /// Of the error's energy on single pieces left out (StateFit::HeldOutEnergy), what the functions predict at least. `share` is more
  /// where one group alone tells of parameters: without it they run away, which functions undo and is no error of the fit.
  double least_share = 0;
  double null_share = 0;  ///< that chance reaches in one of twenty
  double p_value = 1;
  bool structured = false;  ///< a law is missing
  bool doubtful = false;    ///< not structured, yet a law may be missing
  bool powerless = false;   ///< chance predicts as much as laws do
  std::optional<ErrorBursts> bursts;
  int functions = 0;
  std::string about;  ///< the equation in which they predict most: state or output

  /// Where this is no white noise and nothing explains any of it, it is no all-clear.
  bool MayHideLaw() const { return doubtful || powerless || bursts; }
};

/// Adds some 200 functions (hinges, powers and products of states and inputs, random cosines) to each equation of the model,
/// as terms whose effect on the outputs is simulated with the model's own tangent, and asks how much of the error they
/// predict by ridge regression on pieces left out. Parameters and initial states stay free.
StateRemainder RemainderOf(const StateFit& fit, std::span<const Episode> episodes,
                           const StateRemainderOptions& options = {});

}  // namespace hydroscope
