#include "models/dds_connection.h"

#include <array>

#include "models/machine_file/section_text.h"
#include "models/machine_file/table.h"

namespace hydroscope {
namespace {

constexpr int kLastDomain = 232;  // of the DDS interoperability wire protocol, by its port numbers
constexpr std::array<const char*, 3> kTransportNames = {"default", "udp", "shm"};

}  // namespace

std::vector<std::string> WithDdsConnectionKeys(std::vector<std::string> keys) {
  keys.insert(keys.begin(), {"domain", "transport", "interfaces", "peers", "security"});
  return keys;
}

void ReadDdsConnection(TableReader& section, DdsConnection& connection) {
  section.Integer("domain", connection.domain, 0, kLastDomain);
  if (const auto choice = section.Choice("transport", {kTransportNames.begin(), kTransportNames.end()}))
    connection.transport = static_cast<DdsTransport>(*choice);
  section.Texts("interfaces", connection.interfaces);
  section.Texts("peers", connection.peers);
  section.Text("security", connection.security);
}

Pairs DdsConnectionPairs(const DdsConnection& connection) {
  return {{"domain", Plain(connection.domain)},
          {"transport", Quoted(kTransportNames[static_cast<std::size_t>(connection.transport)])},
          {"interfaces", QuotedList(connection.interfaces)},
          {"peers", QuotedList(connection.peers)},
          {"security", Quoted(connection.security)}};
}

}  // namespace hydroscope
