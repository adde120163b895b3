#pragma once

#include <cstddef>

namespace hydroscope {

/// Memory that is freed stays with the process: what was freed behind a stroke is needed at the next one, and is not given back to
/// the system and fetched anew page by page while estimates wait. To be called before threads begin.
void KeepFreedMemory();

/// Reserves the first 128 MB of the heap and asks for them in pages of 2 MB instead of 4 kB, each fetched when it is first touched: a
/// command that needs 50 MB meets 2 000 page faults instead of 13 000, which takes a third of its time. They stay with the process.
/// Does nothing where the system has no such pages (/sys/kernel/mm/transparent_hugepage/enabled: never) or does not give the room.
/// To be called after KeepFreedMemory(), before threads begin. Source: madvise(2), MADV_HUGEPAGE.
void UseHugePages();

/// Fetches `bytes` for the calling thread from the system and frees them, so that with KeepFreedMemory() the first burst of work
/// meets no page faults: allocate, touch, free. Source: Linux Foundation, real-time Linux wiki, "Memory for real-time
/// applications".
void FetchMemory(std::size_t bytes);

}  // namespace hydroscope
