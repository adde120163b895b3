#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace hydroscope {

struct HiddenEffectsOptions {
  int cases = 300;           ///< simulated logs
  std::uint64_t seed = 1;    ///< of the whole campaign
  bool experiments = false;  ///< run the experiment proposed for every ambiguous case and explain again
  std::vector<int> only;     ///< numbers of cases; empty: all
  bool healthy = false;      ///< hide nothing: how often something is claimed
  std::string details;       ///< one line per case to this tab-separated file, "" = none
};

/// Hides effects in simulated logs of varied machines, sizes, speeds and lengths, explains each log as a user
/// would and prints, per kind of case, how often the truth was found, how often a wrong name was given, and
/// how large the sets were, with a confusion matrix. Returns 0 if every goal is reached, else 1.
int RunHiddenEffectsBenchmark(const HiddenEffectsOptions& options);

}  // namespace hydroscope
