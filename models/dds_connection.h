#pragma once

#include <string>
#include <utility>
#include <vector>

namespace hydroscope {

class TableReader;

enum class DdsTransport { kDefault, kUdp, kSharedMemory };

/// How a source or a feed takes part in DDS.
struct DdsConnection {
  int domain = 0;
  DdsTransport transport = DdsTransport::kDefault;  ///< shared memory where possible, else UDP
  std::vector<std::string> interfaces;              ///< addresses of the network cards used; empty: all
  std::vector<std::string> peers;  ///< addresses asked where the network carries no multicast
  std::string security;            ///< folder of the certificates of DDS Security; "": without

  bool operator==(const DdsConnection&) const = default;
};

/// Its keys in a section of the machine file, `keys` behind them.
std::vector<std::string> WithDdsConnectionKeys(std::vector<std::string> keys);
void ReadDdsConnection(TableReader& section, DdsConnection& connection);
/// Keys and what stands behind their "=".
std::vector<std::pair<std::string, std::string>> DdsConnectionPairs(const DdsConnection& connection);

}  // namespace hydroscope
