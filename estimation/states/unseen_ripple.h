#pragma once

#include "estimation/states/fit.h"

namespace hydroscope {

/// Whether a direction that the data do not see is one parameter that acts by the ripple of a shaft alone (RippleName): the record
/// then holds too little ripple to show it, and no course of the inputs would.
bool OnlyRippleShows(const StateModel& model, const UnseenDirection& unseen);

}  // namespace hydroscope
