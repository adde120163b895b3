#include "pipeline/log_fingerprint.h"

#include <gtest/gtest.h>

#include <fstream>

namespace hydroscope {
namespace {

std::string Write(const std::string& name, const std::string& text) {
  const std::string path = testing::TempDir() + "fingerprint_" + name;
  std::ofstream(path, std::ios::binary) << text;
  return path;
}
std::string Rows(int count) {
  std::string text = "t,p_A\n";
  for (int i = 0; i < count; ++i) text += fmt::format("{},{}\n", i * 0.002, i % 97);
  return text;
}

TEST(LogFingerprint, SeesAChangeAtTheBeginningInTheMiddleAndAtTheEnd) {
  const std::string text = Rows(50000);
  const auto original = FingerprintLog(Write("a.csv", text));
  ASSERT_TRUE(original);
  EXPECT_EQ(*FingerprintLog(Write("copy.csv", text)), *original);
  for (const std::size_t at : {std::size_t{10}, text.size() / 2, text.size() - 3}) {
    std::string changed = text;
    changed[at] ^= 1;
    EXPECT_FALSE(*FingerprintLog(Write("b.csv", changed)) == *original) << at;
  }
}

TEST(LogFingerprint, RecognisesALogThatHasGrown) {
  for (const int rows : {100, 50000}) {  // smaller and larger than the chunks
    const std::string text = Rows(rows);
    const std::string path = Write("grown.csv", text);
    const auto before = FingerprintLog(path);
    EXPECT_FALSE(*Continues(path, *before)) << "not grown";
    Write("grown.csv", text + "999,1\n");
    EXPECT_TRUE(*Continues(path, *before));
    Write("grown.csv", "u" + text + "999,1\n");
    EXPECT_FALSE(*Continues(path, *before)) << "another log";
  }
}

TEST(LogFingerprint, ReadsBackWhatItWrote) {
  const RunFingerprint own{{123456789012, 1, 0xffffffff, 3}, "abc-v1"};
  RunFingerprint read;
  ASSERT_TRUE(RunFingerprint::Parse(own.Text(), read));
  EXPECT_EQ(read.log, own.log);
  EXPECT_EQ(read.settings, own.settings);
  EXPECT_FALSE(RunFingerprint::Parse("something else", read));
}

TEST(LogFingerprint, AMissingFileIsBadInputThatNamesIt) {
  const auto print = FingerprintLog("/nonexistent.csv");
  ASSERT_FALSE(print);
  EXPECT_EQ(print.error().kind, ErrorKind::kBadInput);
  EXPECT_NE(print.error().text.find("/nonexistent.csv"), std::string::npos);
}

TEST(FingerprintSettings, DependsOnWhatChangesStrokesOnly) {
  Machine machine;
  machine.name = "press 1";
  const std::string before = FingerprintSettings(machine, "layout");
  machine.name = "press 2";
  machine.description = "new";
  machine.monitors.push_back({"K", 1e9, {}, {}, {}, {}});
  EXPECT_EQ(FingerprintSettings(machine, "layout"), before);
  EXPECT_NE(FingerprintSettings(machine, "other layout"), before);
  machine.gate.stroke_gap = 0.5;
  EXPECT_NE(FingerprintSettings(machine, "layout"), before);
}

}  // namespace
}  // namespace hydroscope
