#pragma once

#include <functional>

#include "diagnosis/explain.h"
#include "models/machine.h"

namespace hydroscope {

/// A cause much like one that is named, or the same to first order, with no more free numbers, may be the right one where a
/// signal it needs is not measured, so that it could not be tried: the name is then not proven, Explanation::unmeasured says
/// which signals would tell. `measured`: whether a channel of the model was.
void DoubtForUntried(const Machine& machine, const std::function<bool(int channel)>& measured,
                     Explanation& x);

}  // namespace hydroscope
