// Runs the tests of one executable, each in a folder of temporary files that is its own: tests that run beside or after one another
// never meet in a file, and none leaves one behind.

#include <gtest/gtest.h>
#include <stdlib.h>

#include <cstdio>
#include <filesystem>
#include <string>
#include <system_error>

namespace {

void PutTemporaryFilesInto(const std::string& folder) {
  setenv("TMPDIR", folder.c_str(), 1);       // of std::filesystem, and of the programs that tests start
  setenv("TEST_TMPDIR", folder.c_str(), 1);  // of testing::TempDir()
}

/// What a test made for those after it stays until all have run.
class FolderOfEachTest : public testing::EmptyTestEventListener {
 public:
  explicit FolderOfEachTest(const std::string& all) : all_(all) {}

 private:
  void OnTestStart(const testing::TestInfo&) override {
    const std::string own = all_ + "/" + std::to_string(++tests_);
    std::filesystem::create_directory(own);
    PutTemporaryFilesInto(own);
  }
  void OnTestEnd(const testing::TestInfo&) override { PutTemporaryFilesInto(all_); }

  std::string all_;
  int tests_ = 0;
};

}  // namespace

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  std::string all = std::filesystem::temp_directory_path() / "hydroscope-test-XXXXXX";
  if (mkdtemp(all.data()) == nullptr) {
    std::perror(all.c_str());
    return 1;
  }
  std::filesystem::permissions(all, std::filesystem::perms(0755));  // some tests look at it as another user
  PutTemporaryFilesInto(all);
  testing::UnitTest::GetInstance()->listeners().Append(new FolderOfEachTest(all));
  const int failed = RUN_ALL_TESTS();
  std::error_code left;
  std::filesystem::remove_all(all, left);
  return failed;
}
