#include "host/text_sink.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <zlib.h>

#include <csignal>
#include <filesystem>

#include "host/text_file.h"

namespace hydroscope {
namespace {

namespace fs = std::filesystem;

class TextSinkTest : public testing::Test {
 protected:
  TextSinkTest() {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  ~TextSinkTest() override { fs::remove_all(folder_); }
  std::string File(const std::string& name) const { return folder_ + "/" + name; }
  std::ptrdiff_t files() const { return std::distance(fs::directory_iterator(folder_), {}); }

 private:
  std::string folder_ = testing::TempDir() + "text_sink";
};

TEST_F(TextSinkTest, AFileHasItsNameOnceItIsWhole) {
  auto sink = TextSink::Open(File("press.csv"));
  ASSERT_TRUE(sink);
  EXPECT_TRUE(sink->Write("t,z\n"));
  EXPECT_FALSE(fs::exists(File("press.csv")));
  EXPECT_TRUE(fs::exists(File("press.csv.part")));
  EXPECT_TRUE(sink->Write("0,1\n"));
  ASSERT_TRUE(sink->Close());
  EXPECT_EQ(*ReadTextFile(File("press.csv")), "t,z\n0,1\n");
  EXPECT_EQ(files(), 1);
}

TEST_F(TextSinkTest, WhatIsGivenUpLeavesTheFileFromBefore) {
  ASSERT_TRUE(WriteTextFile(File("press.csv.gz"), "before"));
  {
    auto sink = TextSink::Open(File("press.csv.gz"));
    ASSERT_TRUE(sink);
    sink->Write("after");
  }
  EXPECT_EQ(files(), 1);
  gzFile file = gzopen(File("press.csv.gz").c_str(), "rb");
  char text[10] = {};
  EXPECT_EQ(gzread(file, text, sizeof text), 6);
  EXPECT_STREQ(text, "before");
  gzclose(file);
}

TEST_F(TextSinkTest, AFullDiskCostsNothingThatWasThere) {
  ASSERT_TRUE(WriteTextFile(File("press.toml"), "name = \"press\"\n"));
  const auto before = std::signal(SIGXFSZ, SIG_IGN);
  rlimit limit{}, small{};
  getrlimit(RLIMIT_FSIZE, &limit);
  small = {.rlim_cur = 1000, .rlim_max = limit.rlim_max};
  setrlimit(RLIMIT_FSIZE, &small);
  const Status written = WriteTextFile(File("press.toml"), std::string(100'000, 'x'));
  setrlimit(RLIMIT_FSIZE, &limit);
  std::signal(SIGXFSZ, before);
  ASSERT_FALSE(written);
  EXPECT_NE(written.error().text.find("press.toml: files may not grow so large"), std::string::npos)
      << written.error().text;
  EXPECT_EQ(*ReadTextFile(File("press.toml")), "name = \"press\"\n");
  EXPECT_EQ(files(), 1);
}

TEST_F(TextSinkTest, LinksAndPermissionsStay) {
  ASSERT_TRUE(WriteTextFile(File("press.toml"), "one"));
  fs::permissions(File("press.toml"), fs::perms::owner_read | fs::perms::owner_write);
  fs::create_symlink("press.toml", File("link.toml"));
  ASSERT_TRUE(WriteTextFile(File("link.toml"), "two"));
  EXPECT_TRUE(fs::is_symlink(File("link.toml")));
  EXPECT_EQ(*ReadTextFile(File("press.toml")), "two");
  EXPECT_EQ(fs::status(File("press.toml")).permissions(), fs::perms::owner_read | fs::perms::owner_write);
}

TEST_F(TextSinkTest, WhatIsNoFileIsWrittenInPlace) {
  EXPECT_TRUE(WriteTextFile("/dev/null", "text"));
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
  EXPECT_FALSE(WriteTextFile("/dev/full", "text"));
  EXPECT_FALSE(WriteTextFile(File("none") + "/press.csv", "text"));
  EXPECT_FALSE(WriteTextFile(testing::TempDir(), "text"));
}

}  // namespace
}  // namespace hydroscope
