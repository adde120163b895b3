#pragma once

#include <vector>

#include "workbench/check_log.h"

namespace hydroscope {

/// Sentences about units and signs that look wrong: a pressure of 200 Pa that is bar, a spool of 40 that is
/// percent, an oil temperature in the wrong scale, a position that rises where the gate wants it to fall.
std::vector<Told> PlausibilityHints(const CheckResult& check);

}  // namespace hydroscope
