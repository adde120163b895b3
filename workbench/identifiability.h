#pragma once

#include <span>
#include <vector>

#include "models/model_structure.h"
#include "workbench/check_log.h"

namespace hydroscope {

/// Verdict, reason and advice for every parameter of a batch fit. Good: known to 10 % (dimensionless: 0.01,
/// but of models with states 10 % as well) with 95 % confidence.
std::vector<CheckedParameter> JudgeParameters(std::span<const Estimate> estimates, const Driving& driving);

/// The same when there is no fit: nothing is identifiable, `why`. `advice`: "" if driving the machine otherwise may help.
std::vector<CheckedParameter> ParametersWithoutFit(const ModelStructure& model, const Told& why,
                                                   const Driving& driving, const Told& advice = {});

/// Half width of the 95 % interval: relative to the value, absolute for dimensionless parameters.
double HalfWidth(const Estimate& estimate);

}  // namespace hydroscope
