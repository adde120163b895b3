#pragma once

#include <cstdint>

namespace hydroscope {

struct FrfBenchmarkOptions {
  int cases = 400;         ///< sweeps of each variation
  std::uint64_t seed = 1;  ///< of the first one's noise
};

/// `hydroscope benchmark frf`: simulated valve sweeps (the published valve and variations of sampling rate,
/// dead time, damping, amplitude and noise), `cases` seeds of each from `seed` on. Prints per variation and
/// parameter the truth, the mean estimate, the coverage of the stated 95 % intervals and the worst error, and
/// the time one sweep takes to evaluate. Returns an exit code: 0 if every f0 is within 0.5 % (2 % for the
/// noisy variation) and the coverage of the published valve within 92 ... 98 % (checked from 100 cases on),
/// else 1.
int RunFrfBenchmark(const FrfBenchmarkOptions& options);

}  // namespace hydroscope
