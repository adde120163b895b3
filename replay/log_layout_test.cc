#include "replay/log_layout.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "replay/date_time.h"

namespace hydroscope {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

LogLayout Detect(const std::string& text, const LogFormat& hints = {}) {
  auto layout = DetectLayout(text, hints, "log.csv");
  EXPECT_TRUE(layout.has_value()) << layout.error().text;
  return layout.value_or(LogLayout{});
}

std::string ErrorOf(const std::string& text, const LogFormat& hints = {}) {
  const auto layout = DetectLayout(text, hints, "log.csv");
  return layout ? "" : layout.error().text;
}

TEST(LogLayout, FindsCommasAndHeader) {
  const LogLayout layout = Detect("t,p_A,z\n0,1.5,2\n0.1,1.6,2\n");
  EXPECT_EQ(layout.separator, ',');
  EXPECT_THAT(layout.names, ElementsAre("t", "p_A", "z"));
  EXPECT_EQ(layout.data_line, 2);
  EXPECT_EQ(layout.data_offset, 8u);
  EXPECT_FALSE(layout.ragged);
}

TEST(LogLayout, FindsDecimalCommasBetweenSemicolons) {
  const LogLayout layout = Detect("t;p\n0,1;1,5\n0,2;1,6\n");
  EXPECT_EQ(layout.separator, ';');
  EXPECT_EQ(layout.decimal, ',');
}

TEST(LogLayout, FindsDecimalCommasBetweenTabs) {
  const LogLayout layout = Detect("t\tp\r\n0,1\t1,5\r\n0,2\t1,6\r\n");
  EXPECT_EQ(layout.separator, '\t');
  EXPECT_EQ(layout.decimal, ',');
  EXPECT_THAT(layout.names, ElementsAre("t", "p"));
}

TEST(LogLayout, FindsRunsOfBlanks) {
  const LogLayout layout = Detect("  t    p\n 0.1   1.5\n 0.2  -1.6\n");
  EXPECT_EQ(layout.separator, ' ');
  EXPECT_EQ(layout.fields, 2u);
}

TEST(LogLayout, NamesColumnsByNumberWithoutHeader) {
  const LogLayout layout = Detect("0.0\t4.4\t1.1\r\n10.0\t4.5\t1.2\r\n");
  EXPECT_FALSE(layout.header);
  EXPECT_THAT(layout.names, ElementsAre("1", "2", "3"));
  EXPECT_EQ(layout.Find("3"), 2u);
}

TEST(LogLayout, FindsUnitRow) {
  const LogLayout layout = Detect("t;p_A;z\n[ms];bar;mm\n0;1;2\n1;1;2\n");
  EXPECT_TRUE(layout.unit_row);
  EXPECT_THAT(layout.units, ElementsAre("ms", "bar", "mm"));
  EXPECT_THAT(layout.names, ElementsAre("t", "p_A", "z"));
  EXPECT_EQ(layout.data_line, 3);
}

TEST(LogLayout, TakesUnitsFromBracketsInNames) {
  const LogLayout layout = Detect("t (s),p_A [bar]\n0,1\n1,1\n");
  EXPECT_THAT(layout.units, ElementsAre("s", "bar"));
  EXPECT_EQ(layout.Find("p_A"), 1u);
  EXPECT_EQ(layout.Find("p_A [bar]"), 1u);
}

TEST(LogLayout, TakesUnitsBehindStrokesAsIso80000WritesThem) {
  const LogLayout layout =
      Detect("t/s,p_A/MPa,T_oil/°C,v/m/s,cycles/min,A/B,m/s\n0,1,2,3,4,5,6\n1,1,2,3,4,5,6\n");
  EXPECT_THAT(layout.units, ElementsAre("s", "MPa", "°C", "m/s", "", "", ""));
  EXPECT_EQ(layout.Find("p_A"), 1u);
  EXPECT_EQ(layout.Find("v"), 3u);
  EXPECT_EQ(layout.Find("cycles"), std::nullopt);
}

TEST(LogLayout, DropsByteOrderMark) { EXPECT_EQ(Detect("\xEF\xBB\xBFt,p\n0,1\n1,2\n").names[0], "t"); }
TEST(LogLayout, DropsQuotes) {
  EXPECT_THAT(Detect("\"t\",\"p, A\"\n0,1\n1,2\n").names, ElementsAre("t", "p, A"));
}
TEST(LogLayout, DropsCommentSignBeforeHeader) {
  EXPECT_THAT(Detect("# t p\n0 1\n1 2\n").names, ElementsAre("t", "p"));
}

TEST(LogLayout, SkipsLinesAboveTheHeader) {
  const LogLayout layout = Detect("Logger 7\nRate: 1000\n\nt,p\n0,1\n1,2\n");
  EXPECT_EQ(layout.skip_lines, 3);
  EXPECT_THAT(layout.names, ElementsAre("t", "p"));
}

TEST(LogLayout, ReadsAcquisitionHeaderWithEventsInSomeRows) {
  const LogLayout layout = Detect(
      "Header Size:  7\r\nSampling Interval:  0.001\r\nSample Number, Date/Time, CHANNEL0, Events\r\n"
      "         1,   06/29/2022 04:05:36.674 PM, -0.0209, DAQ Start\r\n"
      "         2,   06/29/2022 04:05:36.675 PM, -0.0221\r\n         3,   06/29/2022 04:05:36.676 PM, -0.0221\r\n");
  EXPECT_THAT(layout.names, ElementsAre("Sample Number", "Date/Time", "CHANNEL0", "Events"));
  EXPECT_TRUE(layout.ragged);
  EXPECT_EQ(layout.data_line, 4);
}

TEST(LogLayout, ObeysHints) {
  LogFormat hints;
  hints.skip_lines = 1;
  hints.unit_row = true;
  const LogLayout layout = Detect("1,2\nt,p\nfoo,baz\n0,1\n1,2\n", hints);
  EXPECT_THAT(layout.names, ElementsAre("t", "p"));
  EXPECT_THAT(layout.units, ElementsAre("foo", "baz"));
  EXPECT_EQ(layout.data_line, 4);
}

TEST(LogLayout, HintWithoutHeaderKeepsTheFirstRowOfNumbers) {
  LogFormat hints;
  hints.header = false;
  EXPECT_EQ(Detect("0,1\n1,2\n", hints).data_line, 1);
}

TEST(LogLayout, RefusesWhatIsNoLog) {
  EXPECT_THAT(ErrorOf(""), HasSubstr("is empty"));
  EXPECT_THAT(ErrorOf(std::string("a\0b\n", 4)), HasSubstr("binary"));
  EXPECT_THAT(ErrorOf("only words\nand more words\n"), HasSubstr("no rows of numbers"));
}

TEST(LogLayout, TellsPeopleInGermanTooWhatIsNoLog) {
  for (const std::string text : {"", "only words\nand more words\n"}) {
    const auto layout = DetectLayout(text, {}, "log.csv");
    ASSERT_FALSE(layout);
    EXPECT_THAT(layout.error().german, HasSubstr("Log 'log.csv'")) << text;
  }
}

TEST(LogLayout, RefusesTheSameSignTwice) {
  LogFormat hints;
  hints.separator = hints.decimal = ',';
  EXPECT_THAT(ErrorOf("t,p\n0,1\n", hints), HasSubstr("both ','"));
}

TEST(DateTime, ReadsWhatLoggersWrite) {
  constexpr double kAfternoon = 1656518736.0;  // 2022-06-29 16:05:36 UTC
  EXPECT_DOUBLE_EQ(*ParseDateTime("06/29/2022 04:05:36 PM"), kAfternoon);
  EXPECT_DOUBLE_EQ(*ParseDateTime("29/06/2022 16:05:36"), kAfternoon);
  EXPECT_DOUBLE_EQ(*ParseDateTime("29.06.2022 16:05:36,0"), kAfternoon);
  EXPECT_DOUBLE_EQ(*ParseDateTime("2022-06-29T16:05:36Z"), kAfternoon);
  EXPECT_DOUBLE_EQ(*ParseDateTime("2022-06-29 18:05:36+02:00"), kAfternoon);
  EXPECT_DOUBLE_EQ(*ParseDateTime("20220629T160536"), kAfternoon);
  EXPECT_NEAR(*ParseDateTime("06/29/2022 04:05:36.674 PM"), kAfternoon + 0.674, 3e-7);
  EXPECT_DOUBLE_EQ(*ParseDateTime("12:00:01.5 AM"), 1.5);
}

TEST(DateTime, RefusesWhatIsNone) {
  for (const char* text :
       {"", "1.5", "2022-13-01 00:00:00", "25:00:00", "noon", "06/29/2022", "16:05:36 XM", "1:2"})
    EXPECT_FALSE(ParseDateTime(text)) << text;
}

TEST(LogLayout, FindsAllColumnsThatANameMeans) {
  LogLayout layout;
  layout.names = {"t", "p [bar]", "p [V]", "z", "z", "Z"};
  EXPECT_THAT(layout.FindAll("z"), testing::ElementsAre(3, 4)) << "and not one of another case";
  EXPECT_THAT(layout.FindAll("p"), testing::ElementsAre(1, 2));
  EXPECT_THAT(layout.FindAll("p [V]"), testing::ElementsAre(2));
  EXPECT_THAT(layout.FindAll("3"), testing::ElementsAre(2));
  EXPECT_EQ(layout.Find("p"), 1u);
  EXPECT_FALSE(layout.Find("q"));
}

}  // namespace
}  // namespace hydroscope
