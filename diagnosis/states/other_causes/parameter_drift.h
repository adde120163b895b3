#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/told.h"
#include "diagnosis/states/remainder.h"

namespace hydroscope {

/// That it is found where it is and told of nowhere else hold diagnosis/states/other_causes/parameter_drift_test.cc and
/// `hydroscope benchmark state-machines`.
struct ParameterDriftOptions {
  std::size_t least_pieces = 8;  ///< of the log
  double least_share = 0.1;      ///< of the error's energy on pieces left out that a drift must take away
  double beyond_functions = 2;   ///< ... and of what functions of states and inputs take away
  double least_t = 3;            ///< ... over its standard error by pieces
  double least_sizes = 5;        ///< standard errors of the drift itself
  /// Of what the best takes away: another parameter that takes as much may drift in its place.
  double rival_share = 0.9;
};

/// A parameter that moved evenly while the log was recorded.
struct ParameterDrift {
  struct Moved {
    std::string parameter;
    double change = 0, std = 0;  ///< from begin to end, of the parameter's size
    /// Of a parameter near zero, which has no percentages (core/relative_change.h): SI unit of `change` and `std`; else "".
    std::string unit = {};
  };
  std::vector<Moved> moved;  ///< best first: one of them did
  double share = 0;          ///< of the error's energy on pieces left out that it takes away
};

/// The parameter whose even drift over the log explains most of what a fit with constant ones leaves, by linearisation about the
/// fit, on pieces of the log left out in turn; nothing if none explains enough. `left`: of the fit; of a law that is missing, whose
/// functions predict as much, parameters drift where the machine is driven ever harder.
std::optional<ParameterDrift> FindParameterDrift(const StateFit& fit, const StateRemainder& left,
                                                 const ParameterDriftOptions& options = {});

/// A sentence that says so.
Told ParameterDriftText(const ParameterDrift& drift);

}  // namespace hydroscope
