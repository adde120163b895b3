#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace hydroscope {

/// A range of IPv4 addresses, host byte order.
struct Ipv4Range {
  std::uint32_t network = 0, mask = 0;

  bool Contains(std::uint32_t address) const { return (address & mask) == network; }
};
/// "192.168.0.7" or "192.168.0.0/24"; nullopt for anything else, also if bits behind the prefix are set.
std::optional<Ipv4Range> ParseIpv4Range(const std::string& text);

}  // namespace hydroscope
