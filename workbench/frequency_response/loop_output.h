#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "workbench/frequency_response/loop_log.h"

namespace hydroscope {

/// Result of `frf` for a machine in closed loop: for people, for scripts (keys: docs/test_cylinder.md).
std::string LoopText(const LoopLog& measured, const Machine& machine);
nlohmann::json LoopJson(const LoopLog& measured, const Machine& machine);

/// The points that are used, or some `most` of them (ThinnedPoints).
std::vector<const FrequencyPoint*> UsedPoints(const LoopResponse& response, std::size_t most);

/// Phase of a model at a frequency (Hz), rad, without a jump against that of the point beside it.
double PhaseBeside(const TransferModel& model, const std::vector<double>& parameters, double frequency,
                   const FrequencyPoint& point);

}  // namespace hydroscope
