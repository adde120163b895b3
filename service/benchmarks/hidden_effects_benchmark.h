#pragma once

#include <cstdint>
#include <string>

namespace hydroscope {

/// Hides effects in simulated logs of varied machines, sizes, speeds and lengths, explains each log as a user would and
/// prints, per kind of case, how often the truth was found, how often a wrong name was given, and how large the sets
/// were, with a confusion matrix. `details`: one line per case to this file ("" = none). Returns 0 if every goal is
/// reached, else 1.
int RunHiddenEffectsBenchmark(int cases, std::uint64_t seed, const std::string& details);

}  // namespace hydroscope
