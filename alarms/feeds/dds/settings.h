#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "models/dds_transport.h"

namespace hydroscope {

/// Alarm events and findings by DDS (docs/live_protocol.md).
struct DdsFeedSpec {
  static constexpr std::string_view kName = "dds";

  int domain = 0;
  std::string topic = "hydroscope";  ///< <topic>/alarms and <topic>/findings
  DdsTransport transport = DdsTransport::kDefault;
  std::vector<std::string> interfaces = {"127.0.0.1"};  ///< addresses of the network cards used; empty: all
  std::vector<std::string> peers;
  std::string security = "";  ///< as DdsSpec::security

  bool operator==(const DdsFeedSpec&) const = default;
};

}  // namespace hydroscope
