#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "models/live_spec.h"

namespace hydroscope {

/// A range of IPv4 addresses, host byte order.
struct Ipv4Range {
  std::uint32_t network = 0, mask = 0;

  bool Contains(std::uint32_t address) const { return (address & mask) == network; }
};
/// "192.168.0.7" or "192.168.0.0/24"; nullopt for anything else, also if bits behind the prefix are set.
std::optional<Ipv4Range> ParseIpv4Range(const std::string& text);

/// The Modbus TCP server for a SCADA system (docs/register_map.md).
struct ModbusFeedSpec {
  std::string host = "127.0.0.1";  ///< address it listens on
  int port = 1503;                 ///< 0: a free one
  int connections = 16;            ///< at most
  double idle_timeout = 60;        ///< s without a request after which a connection is closed
  std::vector<std::string> allow = {"127.0.0.0/8"};  ///< clients served: addresses and networks
  bool acknowledge = true;                           ///< clients may acknowledge alarms

  bool operator==(const ModbusFeedSpec&) const = default;
};

/// Alarm events and findings by DDS (docs/live_protocol.md).
struct DdsFeedSpec {
  int domain = 0;
  std::string topic = "hydroscope";  ///< <topic>/alarms and <topic>/findings
  DdsTransport transport = DdsTransport::kDefault;
  std::vector<std::string> interfaces = {"127.0.0.1"};  ///< addresses of the network cards used; empty: all
  std::vector<std::string> peers;
  std::string security = "";  ///< as DdsSpec::security

  bool operator==(const DdsFeedSpec&) const = default;
};

/// An MQTT Sparkplug B 3.0 edge node (docs/sparkplug.md).
struct SparkplugFeedSpec {
  std::string broker = "tcp://127.0.0.1:1883";
  std::string group = "hydroscope";
  std::string node;  ///< "": the machine's name
  std::string user;
  std::string password_file;  ///< its first line is the password
  std::string primary_host;   ///< host id without which nothing is told; "": whoever listens
  std::string ca_file;        ///< ssl://: PEM, signs the broker's certificate; "": those of the system
  std::string certificate_file, key_file;  ///< ssl://: PEM, of this node; "": none

  bool operator==(const SparkplugFeedSpec&) const = default;
};

/// The [feeds] part of a machine file: each feed is off unless its section is there.
struct FeedsSpec {
  std::optional<ModbusFeedSpec> modbus;
  std::optional<DdsFeedSpec> dds;
  std::optional<SparkplugFeedSpec> sparkplug;

  bool operator==(const FeedsSpec&) const = default;
};

}  // namespace hydroscope
