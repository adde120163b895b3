#pragma once

#include "workbench/explain/explain_log.h"

namespace hydroscope {

/// "K fell by 10 % during this log (120 s)" for an effect that lets a parameter move over time, "the zero of the
/// sensor ..." likewise; "if it is K_drift, K fell ..." where something else may be it; "" for the others.
Told DriftText(const ExplainResult& result, const EffectEstimate& estimate);

}  // namespace hydroscope
