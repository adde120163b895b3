#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "alarms/feeds/sparkplug/mqtt_connection.h"
#include "alarms/feeds/sparkplug/payload.h"
#include "studies/live/live_rig.h"

namespace hydroscope {

/// A mosquitto of its own, and a host that takes every Sparkplug message.
class CampaignBroker {
 public:
  /// Its files go into `folder`, which exists. `more`: lines of its configuration. Errors: no mosquitto, no
  /// port to be had.
  static Result<std::unique_ptr<CampaignBroker>> Create(const std::string& folder,
                                                        const std::string& more = "");
  ~CampaignBroker();

  /// Without encryption.
  std::string address() const;
  int port() const { return port_; }
  /// Events in the order in which the host got them.
  std::vector<sparkplug::ToldRow> told() const;
  /// Health of a device as its births and data told it last; "" if they did not.
  std::string HealthOf(const std::string& device) const;

 private:
  CampaignBroker() = default;
  void Take(const MqttMessage& message);

  int port_ = 0;
  std::unique_ptr<Child> mosquitto_;
  mutable std::mutex mutex_;
  std::vector<sparkplug::ToldRow> told_;       // guarded, as what follows
  std::map<std::string, std::string> health_;  // by device
  std::unique_ptr<MqttConnection> host_;
};

}  // namespace hydroscope
