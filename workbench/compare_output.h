#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "workbench/compare_log.h"

namespace hydroscope {

/// What `hydroscope compare` tells a person: error beside the noise, per stroke, whiteness, what the residual follows.
std::string CompareText(const CompareResult& result);
/// The JSON of docs/command_line.md; outputs in the unit people read them in.
nlohmann::json CompareJson(const CompareResult& result);

}  // namespace hydroscope
