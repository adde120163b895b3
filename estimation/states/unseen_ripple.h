#pragma once

#include "estimation/states/fit.h"

namespace hydroscope {

/// Whether a direction that the data do not see is one parameter that acts by the ripple of a shaft alone (RippleName): the record
/// then holds no ripple, the parameter plays no part in it, and no course of the inputs would show it.
bool OnlyRippleShows(const StateModel& model, const UnseenDirection& unseen);

}  // namespace hydroscope
