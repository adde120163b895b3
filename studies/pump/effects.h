#pragma once

#include "studies/pump/benchmark.h"

namespace hydroscope {

/// Hides each effect in logs of random pumps, and nothing in as many, and prints what `explain` says. True if nothing is named
/// wrongly and 95 % of the effects are named first.
bool PrintPumpEffects(const PumpBenchmarkOptions& options);

}  // namespace hydroscope
