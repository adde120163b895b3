#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace hydroscope {

/// The Modbus TCP server for a SCADA system (docs/register_map.md).
struct ModbusFeedSpec {
  static constexpr std::string_view kName = "modbus";

  std::string host = "127.0.0.1";  ///< address it listens on
  int port = 1503;                 ///< 0: a free one
  int connections = 16;            ///< at most
  double idle_timeout = 60;        ///< s without a request after which a connection is closed
  std::vector<std::string> allow = {"127.0.0.0/8"};  ///< clients served: addresses and networks
  bool acknowledge = true;                           ///< clients may acknowledge alarms

  bool operator==(const ModbusFeedSpec&) const = default;
};

}  // namespace hydroscope
