#pragma once

#include <array>
#include <string>
#include <vector>

#include "core/bytes.h"
#include "diagnosis/drift/drift_monitor.h"
#include "estimation/frequency_response/frequency_response.h"

namespace hydroscope::drift {

/// Watches the figures of valve checks (natural frequency f0, damping D, dead time T_dead), each check judged
/// by itself: it averages over thousands of samples, so one is enough. A figure has moved if it is off its
/// reference by more than half of the smallest drift worth finding plus DriftThresholds::valve_check standard deviations of check
/// and reference together.
class ValveCheckMonitor {
 public:
  static constexpr std::array kFigureNames = {"f0", "D", "T_dead"};
  static constexpr int kCommissioning = 5;  ///< checks the reference is learned from

  explicit ValveCheckMonitor(const RuleBook& rules) : rules_(&rules) {}

  /// Judges a check, number `sequence`; the first ones are learned from. The finding's sequence numbers count
  /// checks; an empty `parts` means nothing moved.
  DriftFinding Add(const ValveCheck& check, std::int64_t sequence);
  bool commissioned() const { return !curves_.empty(); }

  void Save(ByteWriter& out) const;
  bool Restore(ByteReader& in);

 private:
  static constexpr int kFigures = kFigureNames.size();
  void Learn();

  const RuleBook* rules_;
  std::vector<TemperaturePoint> points_[kFigures];
  std::vector<TemperatureModel> curves_;  ///< per figure, empty while commissioning
  std::int64_t last_good_ = -1;
};

}  // namespace hydroscope::drift
