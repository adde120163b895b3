#include "core/records/estimate.h"

#include "core/records/reason_told.h"

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

Wording ReasonTold(EstimateReason reason) {
  switch (reason) {
    case EstimateReason::kUpdated:
      return {"identified from the newest data and those before",
              "aus den neuesten und früheren Daten bestimmt"};
    case EstimateReason::kNoStroke:
      return {"nothing seen yet", "noch nichts gesehen"};
    case EstimateReason::kTooShort:
      return {"too short to learn from", "zu kurz, um daraus zu lernen"};
    case EstimateReason::kNotExcited:
      return {"these data tell hardly anything about the parameter",
              "diese Daten sagen kaum etwas über den Parameter"};
    case EstimateReason::kConfounded:
      return {"these data cannot tell this parameter from another",
              "diese Daten trennen diesen Parameter nicht von einem anderen"};
    case EstimateReason::kOutsidePhysics:
      return {"the data ask for a value physics forbids; the model misses an effect or a signal is wrong",
              "die Daten verlangen einen Wert, den die Physik verbietet; dem Modell fehlt ein "
              "Effekt, oder ein Signal ist falsch"};
    case EstimateReason::kPoorSignal:
      return {"bad signal quality left too little to learn from",
              "schlechte Signalqualität ließ zu wenig, um daraus zu lernen"};
  }
  return "";
}

const char* ReasonText(EstimateReason reason) { return ReasonTold(reason).english.data(); }

}  // namespace hydroscope
