#include "workbench/explain/odd_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace hydroscope {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

/// Ten strokes, the last five of them of a second log.
LogStrokes TwoLogs() {
  LogStrokes log;
  log.machine.model = "die_cushion";
  log.log_names = {"monday.csv", "tuesday.csv"};
  log.logs = 2;
  for (int s = 0; s < 10; ++s) {
    StrokeRecord stroke;
    stroke.summary.index = s;
    stroke.summary.begin = 5.0 * (s % 5);
    stroke.gram.log = s / 5;
    log.strokes.push_back(stroke);
  }
  return log;
}

ToldOddStrokes Odd(std::vector<std::size_t> strokes) {
  ToldOddStrokes odd;
  odd.odd.strokes = std::move(strokes);
  return odd;
}

TEST(OddText, StrokesOfSeveralLogsAreToldWithTheirLog) {
  const Told text = WhichDiffer(TwoLogs(), {Odd({1, 3, 4, 5, 6, 7})});
  EXPECT_EQ(
      text.english,
      "strokes 1 (of monday.csv, at 5.0 s), 3 (of monday.csv, at 15.0 s), 4 (of monday.csv, at 20.0 s), 5 to 7 (of "
      "tuesday.csv, 0.0 to 10.0 s) differ from the rest");
  EXPECT_THAT(text.german, HasSubstr("(von monday.csv, bei 5,0 s)"));
  EXPECT_THAT(OddStrokesJson(TwoLogs(), {Odd({4, 5})})[0]["logs"], ElementsAre("monday.csv", "tuesday.csv"));
}

TEST(OddText, ThoseOfOneLogAreNot) {
  LogStrokes log = TwoLogs();
  log.logs = 1;
  log.log_names = {"monday.csv"};
  for (StrokeRecord& stroke : log.strokes) stroke.gram.log = 0;
  EXPECT_EQ(WhichDiffer(log, {Odd({1})}).english, "stroke 1 (at 5.0 s) differs from the rest");
  EXPECT_FALSE(OddStrokesJson(log, {Odd({1})})[0].contains("logs"));
}

}  // namespace
}  // namespace hydroscope
