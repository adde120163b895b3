#pragma once

#include <functional>
#include <string>

namespace hydroscope {

/// Hears what ProgressBar would draw: what is done, and its share 0...1. Called from the thread that works, at most ten
/// times a second. Set it before work begins; {} = nobody listens.
using ProgressListener = std::function<void(const std::string& what, double share)>;
void ListenToProgress(ProgressListener listener);

}  // namespace hydroscope
