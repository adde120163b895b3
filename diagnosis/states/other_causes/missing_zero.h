#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/told.h"
#include "estimation/states/fit.h"

namespace hydroscope {

/// That it is found where it is and told of nowhere else holds diagnosis/states/other_causes/missing_zero_test.cc. The shares are
/// those of SamplingOptions: a zero is as much a matter of how the log was measured.
struct MissingZeroOptions {
  int rows = 4000;  ///< that fits with constants are tried on
  double foreseen =
      0.85;  ///< energy left over that before, by linearisation, above which no constant is tried
  double less_error = 0.8;  ///< rms error over that without, below which constants are taken
};

/// Constants in readings that the machine file does not give: the zeros of sensors, which parameters bend to as they would to a
/// law that is missing.
struct MissingZeros {
  struct Zero {
    std::string signal;
    double at = 0;    ///< SI
    double span = 0;  ///< SI, of the readings
  };
  std::vector<Zero> of;
  /// Rms of what is left with them, over that without; of several outputs the mean of squares.
  double error = 1;
};

/// Outputs with a constant beside what the file gives for them, if that leaves clearly less.
std::optional<MissingZeros> FindMissingZeros(const StateFit& fit, std::span<const Episode> episodes,
                                             const MissingZeroOptions& options = {});

/// The machine with a parameter `<signal>_zero` in each of these outputs.
Machine WithZeros(Machine machine, const MissingZeros& zeros);

/// A sentence that says that they were taken.
Told MissingZerosText(const MissingZeros& zeros, const Machine& machine);

}  // namespace hydroscope
