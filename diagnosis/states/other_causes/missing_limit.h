#pragma once

#include <optional>
#include <span>
#include <string>

#include "core/told.h"
#include "estimation/states/fit.h"

namespace hydroscope {

/// That it is found where it is and told of nowhere else hold diagnosis/states/other_causes/missing_limit_test.cc and
/// `hydroscope benchmark state-machines`.
struct MissingLimitOptions {
  int rows = 4000;            ///< that fits with a limit are tried on
  double least_share = 0.01;  ///< of the rows, in which the model must go beyond the end of what is read
  double beyond = 1;  ///< standard deviations of an output's noise that it must go beyond all readings by
  double flat = 4;    ///< ... and that its readings may then be apart ...
  double least_flat = 0.6;  ///< ... in so many of these rows
  double less_error = 0.7;  ///< rms error with the limit over that without, below which it is told of
};

/// A limit that the machine file does not state: readings of an output stand at one value where the model goes on.
struct MissingLimit {
  std::string signal;
  std::string state;  ///< that stops there; "": the sensor does, and what it measures goes on
  bool upper = true;
  double at = 0;     ///< SI
  double share = 0;  ///< of the rows, in which the model goes beyond
  /// Rms of what is left with it, over that without; of several outputs the mean of squares.
  double error = 1;
};

/// The limit with which least is left, if that is clearly less: of a state that an output reads, and of the reading itself. What
/// the model does beyond looks like a law that is missing, and covers those that are.
std::optional<MissingLimit> FindMissingLimit(const StateFit& fit, std::span<const Episode> episodes,
                                             const MissingLimitOptions& options = {});

/// The machine with it.
Machine WithLimit(Machine machine, const MissingLimit& limit);

/// A sentence that says so; `taken`: what is told is of the machine with it.
Told MissingLimitText(const MissingLimit& limit, const Machine& machine, bool taken);

}  // namespace hydroscope
