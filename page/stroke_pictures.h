#pragma once

#include <nlohmann/json_fwd.hpp>

#include "workbench/compare_log.h"

namespace hydroscope {

/// Measured beside modelled of every stroke of a comparison, an array in the order of CompareResult::per_stroke: `stroke`,
/// `begin` and `step` (s), `unit`, `measured`, `modelled`, `noise` (standard deviation that sensor noise gives their
/// difference), `signals` (`name`, `unit`, `values`: means over each window), and `free_run` (`unit`, `step`, `measured`,
/// `simulated`) or null.
nlohmann::json StrokePicturesJson(const CompareResult& result);

}  // namespace hydroscope
