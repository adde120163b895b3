#pragma once

#include <optional>
#include <string>

#include "core/result.h"
#include "diagnosis/explain.h"
#include "models/machine.h"

namespace hydroscope {

/// What a test off the log said of an effect, which `explain` then takes for known.
struct MeasuredEffect {
  std::string effect;                ///< id
  std::optional<MeasuredSize> size;  ///< SI; nothing: it is forgotten
};
/// Of {"effect", "size", "std"}, SI, "size" absent or null to forget it. Errors as ParseWorkRequest.
Result<MeasuredEffect> ParseMeasuredEffect(const std::string& body);

/// Error: the library of the machine holds no such effect.
Status CheckInLibrary(const MeasuredEffect& measured, const Machine& machine);

}  // namespace hydroscope
