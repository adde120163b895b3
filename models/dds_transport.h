#pragma once

#include <string>

namespace hydroscope {

class TableReader;

enum class DdsTransport { kDefault, kUdp, kSharedMemory };

/// `transport` of a section about DDS.
void ReadTransport(TableReader& section, DdsTransport& transport);
/// As a file names it, with its quotes.
std::string TransportName(DdsTransport transport);

}  // namespace hydroscope
