#include "page/work/scratch_folder.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

namespace hydroscope {
namespace {

namespace fs = std::filesystem;

TEST(ScratchFolder, TakesAwayWhatAKilledProgramLeftAndNothingElse) {
  const fs::path own = fs::path(testing::TempDir()) / "scratch_test";
  fs::remove_all(own);
  fs::create_directory(own);
  setenv("TMPDIR", own.c_str(), 1);
  const fs::path left = own / "hydroscope_page_killed", strange = own / "hydroscope_page_strange";
  for (const fs::path& folder : {left, strange}) fs::create_directory(folder);
  std::ofstream(left / "in_use").close();
  std::ofstream(left / "press.csv") << "t\n";
  {
    const auto first = ScratchFolder::Make();
    ASSERT_TRUE(first);
    EXPECT_FALSE(fs::exists(left));
    EXPECT_TRUE(fs::exists(strange)) << "nobody knows whether it is in use";
    const auto second = ScratchFolder::Make();
    ASSERT_TRUE(second);
    EXPECT_TRUE(fs::exists((*first)->path())) << "it is in use";
  }
  EXPECT_EQ(std::distance(fs::directory_iterator(own), {}), 1);
  unsetenv("TMPDIR");
  fs::remove_all(own);
}

}  // namespace
}  // namespace hydroscope
