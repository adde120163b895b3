#pragma once

#include <cstddef>

namespace hydroscope {

/// Memory that is freed stays with the process: what was freed behind a stroke is needed at the next one, and is not given back to
/// the system and fetched anew page by page while estimates wait. To be called before threads begin.
void KeepFreedMemory();

/// Fetches `bytes` for the calling thread from the system and frees them, so that with KeepFreedMemory() the first burst of work
/// meets no page faults: allocate, touch, free. Source: Linux Foundation, real-time Linux wiki, "Memory for real-time
/// applications".
void FetchMemory(std::size_t bytes);

}  // namespace hydroscope
