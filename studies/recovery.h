#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/result.h"

namespace hydroscope {

struct RecoveryOptions {
  double seconds = 120;    ///< of each log
  std::uint64_t seed = 1;  ///< of the first log of each effect
  int seeds = 1;           ///< logs per effect
  std::string effect;      ///< only this one, "" = all
  bool random = false;     ///< machines, sizes and shapes drawn at random, off every grid
};

/// What a recovered value is.
enum class RecoveredKind { kSize, kShape, kBase };

/// One parameter of one fit against the truth it was simulated with.
struct RecoveredValue {
  std::string name, unit;
  double truth = 0, value = 0, std = 0;  ///< SI; value +- 1.96 std is the 95 % interval
  RecoveredKind kind = RecoveredKind::kBase;
  double Deviation() const { return (value - truth) / std; }
};

/// Simulates the example press with `effect` at its typical size (the simulator's own equations), or a random machine
/// with a random size and shape, and fits the machine's model with the effect added, thresholds and widths found
/// by the fit. First value: the size of the effect; then its shape as far as the simulator has numbers for it,
/// then the base parameters. Strokes are drawing strokes with speeds of their own; effects of the metering edge
/// that these do not use (spool overlap, asymmetry) are given strokes that rest and return too. Empty if a random
/// effect leaves no error to speak of: its threshold is never reached, say.
Result<std::vector<RecoveredValue>> RecoverEffect(const std::string& effect, double seconds,
                                                  std::uint64_t seed, bool random = false);

/// All effects of the library, or one. Prints sizes and deviations of every parameter in standard deviations. Returns
/// 0 if each stated interval of three standard deviations holds its truth (of one log per effect), or 90 % or
/// more of all 95 % intervals, and of those of the sizes and of the shapes (of several); else 1.
int RunRecovery(const RecoveryOptions& options);

}  // namespace hydroscope
