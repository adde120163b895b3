#pragma once

#include <nlohmann/json_fwd.hpp>

#include "workbench/compare_log.h"
#include "workbench/states/states_log.h"

namespace hydroscope {

/// Measured beside modelled of every stroke of a comparison, an array in the order of CompareResult::per_stroke: `stroke`,
/// `begin` and `step` (s), `unit`, `measured`, `modelled`, `noise` (standard deviation that sensor noise gives their
/// difference), `signals` (`name`, `unit`, `values`: means over each window), and `free_run` (`unit`, `step`, `measured`,
/// `simulated`) or null.
nlohmann::json StrokePicturesJson(const CompareResult& result);

/// The same of a machine with states, whose model runs by itself through each episode: `modelled` is that run. Of long episodes
/// every so many rows. `noise` is empty; `outputs` (`name`, `unit`, `measured`, `modelled`, `noise`: what stays of the error where
/// past errors may be used, so at most this is noise of the sensor) has all outputs, of which the first is the picture's own.
nlohmann::json EpisodePicturesJson(const StatesFit& fit);

}  // namespace hydroscope
