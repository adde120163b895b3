#pragma once

#include <functional>

#include "host/output.h"

namespace hydroscope {

/// Runs `work` for 0 ... count - 1 on `threads` threads (0: as many as the computer has cores) and tells the progress;
/// which thread does which does not matter as long as `work` keeps what it finds under its own index.
void ForEachCase(int count, ProgressBar& progress, const std::function<void(int)>& work, int threads = 0);

/// CPU time of this thread, s.
double ThreadSeconds();

}  // namespace hydroscope
