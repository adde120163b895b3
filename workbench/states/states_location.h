#pragma once

#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <vector>

#include "core/effect_units.h"
#include "core/units.h"
#include "diagnosis/remainder/remainder_shape.h"
#include "diagnosis/states/missing_law.h"
#include "diagnosis/states/remainder.h"

namespace hydroscope {

/// Where the free run of a fit errs in one output.
struct OutputErrors {
  std::string output;
  DisplayUnit unit;  ///< of its errors, as shown
  Residuals residuals;
  ErrorLocation location;  ///< nothing stands out of a fit that leaves noise alone
};

/// All outputs, the one first that errs by the largest share of its variation. `left`: of this fit.
std::vector<OutputErrors> LocateErrors(const StateFit& fit, std::span<const Episode> episodes,
                                       const StateRemainder& left);

/// What is missing in an equation, as shown.
struct ShownLaw {
  std::string equation;
  RemainderShape shape;  ///< values SI, of a state its rate
  EffectUnit unit;       ///< of its values
};
ShownLaw Shown(const MissingLaw& law, const StateModel& model);

/// A line for each range that stands out; "" if none does.
std::string LocatedText(const std::vector<OutputErrors>& errors);
/// The arrays "located" and "maps": as of any machine, and of each entry `output` and `error_unit`. Maps are of the first output.
nlohmann::json LocatedJson(const std::vector<OutputErrors>& errors);
nlohmann::json MapsJson(const std::vector<OutputErrors>& errors);

}  // namespace hydroscope
