#include "core/records.h"

namespace hydroscope {

const char* ReasonName(EstimateReason reason) {
  switch (reason) {
    case EstimateReason::kUpdated:
      return "updated";
    case EstimateReason::kNoStroke:
      return "no_stroke";
    case EstimateReason::kTooShort:
      return "too_short";
    case EstimateReason::kNotExcited:
      return "not_excited";
    case EstimateReason::kConfounded:
      return "confounded";
    case EstimateReason::kOutsidePhysics:
      return "outside_physics";
    case EstimateReason::kPoorSignal:
      return "poor_signal";
  }
  return "unknown";
}

const char* ReasonText(EstimateReason reason) {
  switch (reason) {
    case EstimateReason::kUpdated:
      return "identified from the newest data and those before";
    case EstimateReason::kNoStroke:
      return "nothing seen yet";
    case EstimateReason::kTooShort:
      return "too short to learn from";
    case EstimateReason::kNotExcited:
      return "nothing moved what the parameter acts on; the value is an older one";
    case EstimateReason::kConfounded:
      return "these data cannot tell this parameter from another";
    case EstimateReason::kOutsidePhysics:
      return "the data ask for a value physics forbids; the model misses an effect or a signal is wrong";
    case EstimateReason::kPoorSignal:
      return "bad signal quality left too little to learn from";
  }
  return "";
}

}  // namespace hydroscope
