#pragma once

#include <optional>
#include <vector>

#include "estimation/frequency_response/frequency_response.h"

namespace hydroscope {

/// The model of a broadband record whose two channels share a disturbance, such as a hum, at a few frequencies at which the
/// command is weak. If the model `of_all` points used misfits, it is fitted to those of a strong command, and weak points
/// far from it are marked kDisturbed, in turn until none changes. nullopt, and no point is marked, if that is not it: more
/// than a fifth of the points would be left out, or the others fit hardly better. `correlation` and `sample_period` (s) as
/// in FitValveModel.
std::optional<ValveModel> FitWithoutDisturbed(std::vector<FrequencyPoint>& points, const ValveModel& of_all,
                                              double correlation, double sample_period);

}  // namespace hydroscope
