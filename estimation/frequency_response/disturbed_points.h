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

/// The model of stepped sines of which one frequency is that of a disturbance, such as a hum, in the response. If the model
/// `of_all` points used misfits, each point is left out in turn; where without one of them the others fit within kMisfit times
/// their noise, and it lies far off their model, it is marked kOffTheOthers. nullopt, and no point is marked, if that is not it, or where harmonics
/// at other points say that the valve is not linear.
std::optional<ValveModel> FitWithoutOne(std::vector<FrequencyPoint>& points, const ValveModel& of_all,
                                        double sample_period);

}  // namespace hydroscope
