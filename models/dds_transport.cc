#include "models/dds_transport.h"

#include <array>

#include "models/machine_file/table.h"
#include "models/machine_file/toml_text.h"

namespace hydroscope {
namespace {

constexpr std::array<const char*, 3> kTransportNames = {"default", "udp", "shm"};

}  // namespace

void ReadTransport(TableReader& section, DdsTransport& transport) {
  if (const auto choice = section.Choice("transport", {kTransportNames.begin(), kTransportNames.end()}))
    transport = static_cast<DdsTransport>(*choice);
}

std::string TransportName(DdsTransport transport) {
  return Quoted(kTransportNames[static_cast<std::size_t>(transport)]);
}

}  // namespace hydroscope
