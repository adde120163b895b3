#include "pipeline/run_summary.h"

#include <gtest/gtest.h>

namespace hydroscope {
namespace {

TEST(RunSummary, ReadsBackWhatItWrote) {
  RunSummary s;
  s.sample_period = 0.002;
  s.rows = 45000;
  s.rejected_rows = 2;
  s.gated = 300;
  s.used = 200;
  s.discarded_strokes = 1;
  s.flagged = {{"p_A", {{"spike", 3}, {"missing", 4}}}};
  s.absent = {"T_oil"};
  s.findings = {{17, "p_A", "x", "a number"}};
  s.noise_scale = 4.5;
  s.evidence_scale = 2;
  s.stopped = "torn";
  const RunSummary read = ParseRunSummary(FormatRunSummary(s));
  EXPECT_EQ(FormatRunSummary(read), FormatRunSummary(s));
  EXPECT_EQ(read.FlaggedValues(), 7);
  EXPECT_EQ(read.findings.front().line, 17);
  EXPECT_EQ(read.stopped, "torn");
  EXPECT_EQ(read.noise_scale, 4.5);
  EXPECT_EQ(read.evidence_scale, 2);
}

TEST(RunSummary, WhatIsNoSummaryIsEmpty) {
  EXPECT_EQ(ParseRunSummary("").rows, 0);
  EXPECT_EQ(ParseRunSummary("[1, 2").rows, 0);
  EXPECT_EQ(ParseRunSummary("{}").rows, 0);
  EXPECT_FALSE(ParseRunSummary("{}").noise_scale);
  EXPECT_FALSE(ParseRunSummary(R"({"noise_scale": 0})").noise_scale);
  EXPECT_EQ(ParseRunSummary(R"({"rows": "many"})").rows, 0);
  EXPECT_EQ(ParseRunSummary(R"({"rows": 3, "findings": [7]})").rows, 0);
}

TEST(RunSummary, TextThatIsNoUtf8IsReplaced) {
  RunSummary s;
  s.findings = {{1, "p_A", "\xff\xfe", "a number"}};
  EXPECT_EQ(ParseRunSummary(FormatRunSummary(s)).findings.front().expected, "a number");
}

TEST(FindingText, OfAColumnThatIsNotThereNamesNoLine) {
  EXPECT_EQ(FindingText({0, "U_v", "no such column", "a column for the optional signal 'U_v'"}),
            "column U_v: found 'no such column', expected a column for the optional signal 'U_v'");
}

TEST(FindingText, NamesLineColumnAndValue) {
  EXPECT_EQ(FindingText({17, "p_A", "x", "a number"}), "line 17, column p_A: found 'x', expected a number");
}

}  // namespace
}  // namespace hydroscope
