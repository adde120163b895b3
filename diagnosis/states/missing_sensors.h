#pragma once

#include <span>
#include <string>
#include <vector>

#include "estimation/states/fit.h"

namespace hydroscope {

/// When another sensor is worth a sentence; none of them decides a verdict.
struct MissingSensorOptions {
  /// Relative standard error of a parameter from which on another sensor is asked for: its 95 % interval reaches half a per cent
  /// to either side ...
  double loose = 0.0025;
  double together = 4;  ///< ... if it is so many times less where the other parameters are known
  double noise = 0.01;  ///< of a sensor that is not there, of its signal's variation
  /// Factor by which a sensor must lower one of these errors to be named: as four times the log does.
  double helps = 2;
};

/// What parameters would be told to with one more sensor.
struct MissingSensor {
  std::string signal;
  std::vector<double> std;  ///< relative, per parameter of ToldTogether
};

/// Parameters that the data tell in combinations but not singly; empty where no sensor would help.
struct ToldTogether {
  std::vector<std::string> parameters;
  std::vector<double> std;             ///< relative, as it is
  std::vector<MissingSensor> sensors;  ///< outputs of the machine's kind that are not measured, best first
};

/// Computed from the sensitivities of the fit and, of each output of the kind that the machine does not measure, from those the
/// model has of it along the same episodes.
ToldTogether FindToldTogether(const StateFit& fit, std::span<const Episode> episodes,
                              const MissingSensorOptions& options = {});

}  // namespace hydroscope
