#include "host/resident_memory.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <fstream>
#include <string>
#include <vector>

#include "core/parallel/wide.h"

namespace hydroscope {
namespace {

long PageFaults() {
  rusage used{};
  getrusage(RUSAGE_SELF, &used);
  return used.ru_minflt;
}

TEST(ResidentMemory, IsFetchedInHugePagesWhereTheSystemHasThem) {
#ifdef HYDROSCOPE_SANITIZED
  GTEST_SKIP() << "a sanitizer fetches memory by itself";
#endif
  std::string enabled;
  std::getline(std::ifstream("/sys/kernel/mm/transparent_hugepage/enabled"), enabled);
  if (enabled.find("[madvise]") == std::string::npos && enabled.find("[always]") == std::string::npos)
    GTEST_SKIP() << "this system has no huge pages";
  KeepFreedMemory();
  UseHugePages();
  constexpr std::size_t kPiece = 1 << 18, kPieces = 128, kPage = 4096;
  std::vector<std::vector<char>> pieces(kPieces);
  const long before = PageFaults();
  for (std::vector<char>& piece : pieces) piece.resize(kPiece);
  EXPECT_LT(PageFaults() - before, static_cast<long>(kPieces * kPiece / kPage / 4));
}

}  // namespace
}  // namespace hydroscope
