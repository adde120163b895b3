#include "monitor/common_cause.h"

#include <gtest/gtest.h>

namespace hydroscope {
namespace {

drift::DriftFinding Finding(std::int64_t number, std::int64_t since, const char* quantity = "K",
                            double size = -1) {
  drift::DriftFinding finding;
  finding.number = number;
  finding.state = drift::FindingState::kNamed;
  finding.rule = "rule";
  finding.since.last_before = since - 1;
  finding.parts.push_back({quantity, "Pa", size, 0.1, 10, 0.5, false});
  return finding;
}

class CommonCauseTest : public testing::Test {
 protected:
  CommonCauseTest() {
    rule_.when = {{"K", drift::Movement::kDown}};
    rule_.axes = 2;
    rule_.within = 20;
  }
  /// A finding that is named 10 strokes after its change and stands for `strokes` (0: still).
  void Stands(int axis, std::int64_t since, std::int64_t strokes = 0, const char* quantity = "K") {
    FindingHistory& history = axes_[axis];
    const std::int64_t from = since + 10;
    history.Follow({Finding(from, since, quantity)}, from, static_cast<double>(from));
    if (strokes > 0) history.EndAll(from + strokes, static_cast<double>(from + strokes));
  }
  std::vector<CommonCause> Causes() const {
    const FindingHistory* axes[] = {&axes_[0], &axes_[1], &axes_[2]};
    return CommonCauses(rule_, axes);
  }

  drift::Rule rule_;
  FindingHistory axes_[3];
};

TEST_F(CommonCauseTest, BeginsWhenTheLastAxisNeededIsNamed) {
  Stands(0, 100);
  EXPECT_TRUE(Causes().empty()) << "one axis is no common cause";
  Stands(2, 115);
  ASSERT_EQ(Causes().size(), 1u);
  const CommonCause cause = Causes().front();
  EXPECT_EQ(cause.from, 125);
  EXPECT_EQ(cause.from_time, 125);
  EXPECT_TRUE(cause.StillStands());
  ASSERT_EQ(cause.members.size(), 2u);
  EXPECT_EQ(cause.members[0].axis, 0);
  EXPECT_EQ(cause.members[1].axis, 2);
}

TEST_F(CommonCauseTest, ChangesFarApartAreNotTogether) {
  Stands(0, 100);
  Stands(1, 121);
  EXPECT_TRUE(Causes().empty());
}

TEST_F(CommonCauseTest, TwoFindingsOfOneAxisAreNotTwoAxes) {
  axes_[0].Follow({Finding(1, 100), Finding(2, 105)}, 120, 120);
  EXPECT_TRUE(Causes().empty());
}

TEST_F(CommonCauseTest, AnotherQuantityOrDirectionDoesNotCount) {
  Stands(0, 100);
  Stands(1, 100, 0, "V0");
  axes_[2].Follow({Finding(1, 100, "K", 1)}, 110, 110);
  EXPECT_TRUE(Causes().empty());
}

TEST_F(CommonCauseTest, WhatCameAndWentIsSeenWhicheverAxisIsJudgedLast) {
  Stands(0, 100, 50);
  Stands(1, 105, 100);
  ASSERT_EQ(Causes().size(), 1u);
  EXPECT_EQ(Causes()[0].from, 115);
  EXPECT_EQ(Causes()[0].to, 160);
  Stands(2, 110);
  ASSERT_EQ(Causes().size(), 1u) << "axis 2 takes over from axis 0";
  EXPECT_EQ(Causes()[0].to, 215);
}

TEST_F(CommonCauseTest, ItComesAgain) {
  Stands(0, 100, 50);
  Stands(1, 100, 50);
  Stands(0, 300);
  Stands(1, 300);
  ASSERT_EQ(Causes().size(), 2u);
  EXPECT_FALSE(Causes()[0].StillStands());
  EXPECT_EQ(Causes()[1].from, 310);
  EXPECT_TRUE(Causes()[1].StillStands());
}

TEST(FindingHistory, ASuspicionIsNoFinding) {
  FindingHistory history;
  drift::DriftFinding finding = Finding(1, 100);
  finding.state = drift::FindingState::kUndecided;
  history.Follow({finding}, 110, 110);
  EXPECT_TRUE(history.findings().empty());
}

TEST(FindingHistory, IsRestoredAsItWasSaved) {
  FindingHistory history, restored;
  history.Follow({Finding(1, 100), Finding(2, 105, "V0", 1)}, 120, 60.5);
  history.Follow({Finding(2, 105, "V0", 1)}, 130, 65);
  ByteWriter out;
  history.Save(out);
  const std::vector<std::uint8_t> bytes = out.Take();
  ByteReader in(bytes);
  ASSERT_TRUE(restored.Restore(in));
  EXPECT_TRUE(in.at_end());
  ASSERT_EQ(restored.findings().size(), 2u);
  EXPECT_EQ(restored.findings()[0].to, 130);
  EXPECT_EQ(restored.findings()[0].to_time, 65);
  EXPECT_EQ(restored.findings()[1].movements, (std::map<std::string, int>{{"V0", 1}}));
  EXPECT_EQ(restored.findings()[1].alarm, "rule");
  EXPECT_EQ(restored.findings()[1].to, StandingFinding::kStillStands);
  ByteReader cut({bytes.data(), bytes.size() - 1});
  EXPECT_FALSE(restored.Restore(cut));
}

}  // namespace
}  // namespace hydroscope
