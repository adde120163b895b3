#include "host/resident_memory.h"

#include <malloc.h>

#include <vector>

namespace hydroscope {
namespace {

constexpr int kMapped = 1 << 20;  // bytes from which an allocation has a mapping of its own
constexpr int kKept = 64 << 20;   // bytes
constexpr std::size_t kPage = 4096, kPiece = 64 * kPage;

}  // namespace

void KeepFreedMemory() {
  mallopt(M_TRIM_THRESHOLD, kKept);
  mallopt(M_MMAP_THRESHOLD, kMapped);
}

void FetchMemory(std::size_t bytes) {
  std::vector<std::vector<char>> pieces(bytes / kPiece);
  for (std::vector<char>& piece : pieces) piece.resize(kPiece);  // writes zeros: every page is there
}

}  // namespace hydroscope
