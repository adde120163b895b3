#pragma once

#include <string>
#include <vector>

#include "workbench/explain/explain_log.h"

namespace hydroscope {

/// An effect that explains part of an error without being proven: what can be said all the same is its family and where it is
/// at work (Effect::family, Effect::where), in the words of the effect itself.
struct Relative {
  std::string id;
  /// "oil is lost above 164 bar; nearest relative: Relief valve opening early (relief_valve)"
  Told sentence;
};

/// Those of an explanation that is partial, in the order in which they were added; [] of any other.
std::vector<Relative> RelativesOf(const ExplainResult& result);

/// What a law that goes with the rate of a signal means more often than physics; "" of any other.
Told LateSignal(const ProposedLaw& law);

}  // namespace hydroscope
