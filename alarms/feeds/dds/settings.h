#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "models/dds_connection.h"

namespace hydroscope {

/// Alarm events and findings by DDS (docs/live_protocol.md).
struct DdsFeedSpec : DdsConnection {
  static constexpr std::string_view kName = "dds";

  DdsFeedSpec() { interfaces = {"127.0.0.1"}; }

  std::string topic = "hydroscope";  ///< <topic>/alarms and <topic>/findings

  bool operator==(const DdsFeedSpec&) const = default;
};

}  // namespace hydroscope
