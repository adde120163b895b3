#pragma once

#include <cstdint>
#include <string>

namespace hydroscope {

struct SinceOptions {
  int cases = 100;         ///< histories
  std::uint64_t seed = 1;  ///< of the whole campaign
  std::string effect;      ///< what appears where one effect does, "" = any of the simulator
  std::string details;     ///< one line per history to this tab-separated file, "" = none
};

/// What changed at a known time: logs of a simulated machine before and after are replayed into a trend
/// database and `explain --since` is asked. In half of the histories one effect appears; in the others it
/// appears beside one that was there, one grows, only a parameter of the machine moves, or nothing changes,
/// with and without an effect that was there all the time. Prints per kind how often the right cause stood
/// first and in the set, how often another one was named instead of it or beside it, and how often nothing
/// was said. Returns 0 if every goal is reached, else 1.
int RunSinceBenchmark(const SinceOptions& options);

}  // namespace hydroscope
