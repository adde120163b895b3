#pragma once

#include <cstdint>
#include <string>

namespace hydroscope {

/// Processor time (s), resident memory (bytes) and open descriptors of a process ("self" or its id), from
/// /proc; zero if it is gone.
struct ProcessUse {
  double cpu = 0;
  std::int64_t memory = 0;
  int descriptors = 0;
};
ProcessUse UseOf(const std::string& process);

}  // namespace hydroscope
