// Runs the tests of one executable in a folder of temporary files that is theirs alone: tests that run beside one another never
// meet in a file, and none leaves one behind.

#include <gtest/gtest.h>
#include <stdlib.h>

#include <cstdio>
#include <filesystem>
#include <string>
#include <system_error>

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  std::string own = std::filesystem::temp_directory_path() / "hydroscope-test-XXXXXX";
  if (mkdtemp(own.data()) == nullptr) {
    std::perror(own.c_str());
    return 1;
  }
  std::filesystem::permissions(own, std::filesystem::perms(0755));  // some tests look at it as another user
  setenv("TMPDIR", own.c_str(), 1);       // of std::filesystem, and of the programs that tests start
  setenv("TEST_TMPDIR", own.c_str(), 1);  // of testing::TempDir()
  const int failed = RUN_ALL_TESTS();
  std::error_code left;
  std::filesystem::remove_all(own, left);
  return failed;
}
