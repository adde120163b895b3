#include "host/resident_memory.h"

#include <malloc.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <vector>

namespace hydroscope {
namespace {

constexpr int kMapped = 1 << 20;  // bytes from which an allocation has a mapping of its own
constexpr int kKept = 64 << 20;   // bytes
constexpr int kReserved = 128 << 20, kUsualGrowth = 128 << 10;  // bytes
constexpr std::size_t kHugePage = 2 << 20;
constexpr std::size_t kPage = 4096, kPiece = 64 * kPage;

}  // namespace

void KeepFreedMemory() {
  mallopt(M_TRIM_THRESHOLD, kKept);
  mallopt(M_MMAP_THRESHOLD, kMapped);
}

void UseHugePages() {
  mallopt(M_TOP_PAD, kReserved);
  void* const beyond = std::malloc(kMapped / 2);  // more than the heap has when a program begins: it grows
  const auto begin = (reinterpret_cast<std::uintptr_t>(beyond) + kHugePage - 1) / kHugePage * kHugePage;
  mallopt(M_TOP_PAD, kUsualGrowth);
  mallopt(M_TRIM_THRESHOLD, kReserved + kKept);
  std::free(beyond);
  const auto end = reinterpret_cast<std::uintptr_t>(sbrk(0));
  if (begin < end) madvise(reinterpret_cast<void*>(begin), end - begin, MADV_HUGEPAGE);
}

void FetchMemory(std::size_t bytes) {
  std::vector<std::vector<char>> pieces(bytes / kPiece);
  for (std::vector<char>& piece : pieces) piece.resize(kPiece);  // writes zeros: every page is there
}

}  // namespace hydroscope
