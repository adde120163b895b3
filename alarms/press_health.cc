#include "alarms/press_health.h"

#include <algorithm>

namespace hydroscope {
namespace {

bool IsJudged(const Health& axis) {
  return axis.needed == 0 && axis.reason != HealthReason::kLearning &&
         axis.reason != HealthReason::kNothingKnown;
}

}  // namespace

Health JudgePressHealth(const std::vector<AlarmState>& alarms, const ServiceTrouble& trouble,
                        const std::vector<Health>& axes) {
  Health health = JudgePressHealth(alarms, trouble);
  const bool any_judged = axes.empty() || std::ranges::any_of(axes, IsJudged);
  if (any_judged || health.state >= HealthState::kFunctionCheck) return health;
  health.state = HealthState::kFunctionCheck;
  health.reason = HealthReason::kLearning;
  health.text = "no axis is judged yet";
  health.german = "noch keine Achse wird beurteilt";
  return health;
}

}  // namespace hydroscope
