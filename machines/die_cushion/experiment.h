#pragma once

#include "models/experimenter.h"

namespace hydroscope {

/// Levels of a StrokeSeries of a die cushion. Ram speeds are taken stroke by stroke, cushion pressures one after the
/// other in equal parts of each stroke, and pressures of chamber B after each round of speeds; the oil warms from
/// stroke to stroke.
enum CushionSetting { kRamSpeed, kCushionPressure, kRodPressure, kWarmUp, kCushionSettings };

extern const ExperimentRules kCushionExperiment;

}  // namespace hydroscope
