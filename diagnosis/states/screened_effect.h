#pragma once

#include <optional>
#include <span>
#include <vector>

#include "estimation/states/fit.h"

namespace hydroscope {

/// Of the first look at an effect. What is lost by it `hydroscope benchmark state-machines` counts.
struct ScreeningOptions {
  int draws = 24;    ///< of the effect's parameters from their ranges, beside those of the machine file
  int kept = 2;      ///< best of them
  int unranked = 4;  ///< draws of an effect that delays an input, which cannot be ranked
  std::uint32_t seed = 1;
  /// Energy, in noise variances, that the largest effect in its range must change outputs by.
  double least_seen = 12;
};

/// Whether an effect changes the outputs of a log by more than noise, somewhere in its range.
enum class EffectSeen {
  kYes,
  kNeverActs,  ///< its term stays next to nothing all along the run
  kTakenOver,  ///< parameters and initial states take over what it does
};

/// Where a fit with further effects may begin, and what may be expected of it.
struct ScreenedEffect {
  std::vector<StateStart> starts;  ///< best first, last the machine file's own values
  /// Share of the error's energy that the best of them explains; nothing: of an effect that delays an input.
  std::optional<double> explained;
  EffectSeen seen = EffectSeen::kYes;
};

/// Screens `with`, which is the model of `near` with further effects: parameters known from `near` stay, those of the
/// effects are drawn from their ranges. Which draws are worth a fit is asked of the tangent of `near` (a score test, Rao
/// 1948): each draw's effect enters its equations as a term of size zero, and the share of the error that its sensitivity
/// explains, with parameters and initial states free, ranks the draw. A parameter that the effect is proportional to is set
/// to what the regression gives, inside its range.
ScreenedEffect ScreenEffect(const StateFit& near, const StateModel& with, std::span<const Episode> episodes,
                            const ScreeningOptions& options = {});

}  // namespace hydroscope
