#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace hydroscope {

/// An MQTT Sparkplug B 3.0 edge node (docs/sparkplug.md).
struct SparkplugFeedSpec {
  static constexpr std::string_view kName = "sparkplug";

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

}  // namespace hydroscope
