#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "workbench/fit_log.h"

namespace hydroscope {

/// Aligned table for people: value, 95 % interval, unit, and why a parameter cannot be trusted.
std::string FitText(const FitResult& result);
/// The JSON of docs/command_line.md.
nlohmann::json FitJson(const FitResult& result);
/// Parameters as the JSON object shared by `fit` and `explain`.
nlohmann::json ParametersJson(const std::vector<Estimate>& parameters);
/// Into that: `confounded_with`, `confounded_bias`, `why` and `advice` of those that are.
void AddConfoundings(const std::vector<Confounding>& confounded, nlohmann::json& parameters);
/// `assumed_tolerances`.
nlohmann::json AssumedJson(const std::vector<AssumedTolerance>& assumed);

}  // namespace hydroscope
