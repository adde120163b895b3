#pragma once

#include <map>
#include <mutex>
#include <string>

#include "alarms/health.h"

namespace hydroscope {

/// What the running service knows of the health of its axes, told by those who judge and store, read by all
/// feeds, so that none of them can say something else. Safe from every thread.
class HealthBoard {
 public:
  /// What keeps the service from storing (`kStoring`) or judging (`kJudging`): it makes every axis F.
  enum class Part { kStoring, kJudging };
  void TellTrouble(Part part, ServiceTrouble trouble) {
    std::lock_guard lock(mutex_);
    (part == Part::kStoring ? storing_ : judging_) = std::move(trouble);
  }
  /// Health of an axis as its alarms and strokes have it, without troubles of the service.
  void TellAxis(const std::string& machine, Health health) {
    std::lock_guard lock(mutex_);
    axes_[machine] = std::move(health);
  }
  /// Of an axis nobody has spoken of: function check, nothing known.
  Health Of(const std::string& machine) const {
    std::lock_guard lock(mutex_);
    const ServiceTrouble worst = Worst();
    if (IsTrouble(worst.reason))
      return {HealthState::kFailure, worst.reason, worst.text.english, 0, 0, worst.text.german};
    const auto found = axes_.find(machine);
    return found == axes_.end() ? Health{} : found->second;
  }
  /// kJudgedGood if there is none; storing goes before judging.
  ServiceTrouble trouble() const {
    std::lock_guard lock(mutex_);
    return Worst();
  }

 private:
  const ServiceTrouble& Worst() const { return IsTrouble(storing_.reason) ? storing_ : judging_; }

  mutable std::mutex mutex_;
  ServiceTrouble storing_, judging_;
  std::map<std::string, Health> axes_;
};

}  // namespace hydroscope
