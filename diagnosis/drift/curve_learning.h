#pragma once

#include <Eigen/Dense>
#include <span>
#include <vector>

#include "diagnosis/drift/temperature_model.h"
#include "diagnosis/drift/watched_model.h"

namespace hydroscope::drift {

/// Every quantity of a model over the oil temperature, from strokes of the healthy machine: all curves together by Gauss and
/// Newton on the equations of strokes of nearly one temperature, so that what strokes hardly tell apart (flow and null at one
/// ram speed) is shared out as in one fit. `theta`: regression parameters to begin from; `typical`: values of the quantities, SI.
/// At least one stroke.
std::vector<TemperatureModel> LearnCurves(const WatchedModel& model, std::span<const StrokeEvidence> strokes,
                                          const Eigen::VectorXd& theta, const Eigen::VectorXd& typical);

}  // namespace hydroscope::drift
