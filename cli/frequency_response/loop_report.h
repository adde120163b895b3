#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "diagnosis/closed_loop/change.h"
#include "workbench/frequency_response/loop_log.h"

namespace hydroscope {

/// Result of `frf` for a machine in closed loop: for people, for scripts (keys: docs/test_cylinder.md), as a Bode plot.
std::string LoopText(const LoopLog& measured, const Machine& machine);
nlohmann::json LoopJson(const LoopLog& measured, const Machine& machine);
std::string LoopBodePlot(const LoopLog& measured, const std::string& title);

/// Result of `explain` for it. `before`: what it is compared with, "" = the machine file's references.
std::string LoopChangeText(const LoopComparison& comparison, const LoopLog& after, const Machine& machine,
                           const std::string& before);
nlohmann::json LoopChangeJson(const LoopComparison& comparison, const LoopLog& after, const Machine& machine,
                              const std::string& before);

}  // namespace hydroscope
