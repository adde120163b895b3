#pragma once

#include <memory>
#include <string>
#include <vector>

#include "alarms/feeds/dds/alarm_listener.h"
#include "studies/alarms/campaign_broker.h"

namespace hydroscope {

/// The press of the alarm campaigns: axes of the machine "press".
inline constexpr int kAlarmAxes = 4;
std::string AlarmAxis(int axis);

/// A folder, a broker with a host that takes every Sparkplug event, and a DDS reader.
class AlarmRig {
 public:
  /// Errors: no mosquitto, no broker to be had.
  static Result<std::unique_ptr<AlarmRig>> Create();
  ~AlarmRig();

  std::string File(const std::string& name) const { return folder_ + "/" + name; }
  std::string database() const { return File("press.db"); }
  /// Arguments of the process that is watched.
  std::vector<std::string> Load(const std::string& mode) const;
  /// Events in the order in which the host got them.
  std::vector<sparkplug::ToldRow> told() const { return broker_->told(); }
  const AlarmListener& dds() const { return *dds_; }

 private:
  AlarmRig();
  std::string folder_;
  int domain_ = 0;
  std::unique_ptr<AlarmListener> dds_;
  std::unique_ptr<CampaignBroker> broker_;
};

}  // namespace hydroscope
