#pragma once

#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "models/machine.h"

namespace hydroscope {

/// Watches Machine::episode_marker, row by row.
class EpisodeMarker {
 public:
  explicit EpisodeMarker(const Machine& machine)
      : signal_(machine.episode_marker.empty() ? -1 : machine.SignalIndex(machine.episode_marker)) {}

  /// Whether the marker reads otherwise than when it was last there. `signals`: [signal][row], SI, NaN = no reading.
  bool Changes(const std::vector<std::vector<double>>& signals, std::size_t row) {
    if (signal_ < 0) return false;
    const double now = signals[static_cast<std::size_t>(signal_)][row];
    return std::isfinite(now) && std::exchange(last_, now).value_or(now) != now;
  }

 private:
  int signal_;  ///< -1: the machine has none, and nothing changes
  std::optional<double> last_;
};

}  // namespace hydroscope
