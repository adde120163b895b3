#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/told.h"

namespace hydroscope {

/// Neighbouring registers with what they say.
struct ServedRegisters {
  int first = 0;
  std::vector<std::uint16_t> values;
};

/// What a feed says about itself.
struct FeedStatus {
  std::string name;            ///< "modbus 127.0.0.1:1503"
  bool connected = false;      ///< it can be heard: the port is open, the broker is there
  Told state;                  ///< in words, with the error that keeps it
  int clients = 0;             ///< connected to us now
  std::int64_t delivered = 0;  ///< journal rows up to this sequence number are out
  std::int64_t behind = 0;     ///< journal rows that are not
  std::int64_t errors = 0;     ///< rounds that failed, since the start
  std::int64_t refused = 0;    ///< clients turned away, or ended because of what they sent
  std::string refusal = "";    ///< the latest of these, in words
  /// Those that say something as they are served, of a feed that has registers.
  std::vector<ServedRegisters> registers = {};
};

/// Tells somebody outside what the journal and the trends hold. Each has threads and database handles of its
/// own, so that none can delay another; it stops with its object.
class Feed {
 public:
  virtual ~Feed() = default;
  virtual FeedStatus status() const = 0;
};

}  // namespace hydroscope
