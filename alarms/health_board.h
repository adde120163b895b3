#pragma once

#include <map>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "alarms/health.h"
#include "core/records/estimate_statement.h"

namespace hydroscope {

/// What the running service knows of the health of its axes, and of how their estimates are stated, told by those who judge and
/// store, read by all feeds, so that none of them can say something else. Safe from every thread.
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
  void TellStatements(const std::string& machine, std::vector<EstimateStatement> statements) {
    std::lock_guard lock(mutex_);
    statements_[machine] = std::move(statements);
  }
  /// How estimates of an axis are stated; none: as they are stored.
  std::vector<EstimateStatement> StatementsOf(const std::string& machine) const {
    std::lock_guard lock(mutex_);
    const auto found = statements_.find(machine);
    return found == statements_.end() ? std::vector<EstimateStatement>{} : found->second;
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
  std::map<std::string, std::vector<EstimateStatement>> statements_;
};

}  // namespace hydroscope
