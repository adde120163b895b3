#pragma once

#include <cstddef>

namespace hydroscope {

/// Bytes that a thread of the service works in while the strokes of all its axes end at once.
inline std::size_t BurstMemory(std::size_t axes) { return (2u << 20) + axes * (128u << 10); }

}  // namespace hydroscope
