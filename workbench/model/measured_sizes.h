#pragma once

#include <map>
#include <string>
#include <vector>

#include "core/result.h"
#include "diagnosis/explain.h"
#include "models/machine.h"

namespace hydroscope {

/// Sizes of effects that a test off the log gave (Effect::measured_by), from texts such as "pressure_offset=6.5:0.1": id,
/// size and its standard error in the unit in which `explain` shows the size. Errors: an effect that the library of the
/// machine does not hold, no number, a standard error that is not above 0.
Result<std::map<std::string, MeasuredSize>> MeasuredSizes(const std::vector<std::string>& texts,
                                                          const Machine& machine);

}  // namespace hydroscope
