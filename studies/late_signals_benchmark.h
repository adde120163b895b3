#pragma once

#include <cstdint>

namespace hydroscope {

struct LateSignalsOptions {
  int cases = 96;
  std::uint64_t seed = 1;  ///< of the whole campaign
};

/// Explains logs of varied machines of which one signal is late or filtered by 1 to 13 ms, every second one with quick
/// pressure steps. Prints per signal how often the two are told apart, how often the wrong one is named alone, and by how
/// much of the noise energy the right one leaves more than its twin at most: what ExplainOptions::twin_excess must be well
/// above. Returns 0 unless a wrong one was named alone.
int RunLateSignalsBenchmark(const LateSignalsOptions& options);

}  // namespace hydroscope
