#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "models/machine.h"
#include "models/model_structure.h"
#include "models/stretch.h"

namespace hydroscope {

/// A signal and its rate, both in a balance of the user's own, that swing more than once in two rows.
struct AliasedMotion {
  std::string rate, level;  ///< signals
  double frequency_hz = 0;  ///< of the swing
};

/// Thresholds of FindAliasedMotion.
struct AliasedMotionOptions {
  /// Rate over steps of the level from row to row, or the other way round, beyond which the two are no signal and its rate as they
  /// were sampled: noise makes either less, a swing of three rows and more up to 1.7.
  double least_gain = 2.0;
  /// Standard errors by which the two hang together: noise alone does not.
  double least_t = 10.0;
};

/// Sampled below twice the frequency at which it swings, a motion looks slow, and its inertia comes out wrong in size and sign while
/// the model fits. That a signal and its rate give away: how fast they swing is the ratio of their sizes (Rice 1944), however few
/// rows there are, and from row to row they do not belong together. nullopt where nothing says so.
std::optional<AliasedMotion> FindAliasedMotion(const Machine& machine, const ModelStructure& model,
                                               std::span<const std::vector<Stretch>> strokes, double period,
                                               const AliasedMotionOptions& options = {});

}  // namespace hydroscope
