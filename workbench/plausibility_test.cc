#include "workbench/plausibility.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hydroscope {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// A signal whose readings go from `min` to `max`, SI.
CheckResult With(const std::string& name, const std::string& unit, double min, double max) {
  CheckResult check;
  check.driving.strokes = 5;
  CheckedSignal signal;
  signal.spec.name = signal.spec.column = name;
  signal.spec.unit = unit;
  signal.range.min = min;
  signal.range.max = max;
  signal.range.readings = 1000;
  signal.range.sum = 1000 * 0.5 * (min + max);
  check.signals = {signal};
  return check;
}

TEST(Plausibility, APressureThatIsBarIsToldFromPascal) {
  EXPECT_THAT(InEnglish(PlausibilityHints(With("p_A", "Pa", 3, 210))),
              ElementsAre(HasSubstr("set unit = \"bar\"")));
  EXPECT_THAT(InEnglish(PlausibilityHints(With("p_A", "bar", 3e10, 210e10))),
              ElementsAre(HasSubstr("set unit = \"Pa\"")));
}

TEST(Plausibility, ASpoolInPerCentIsToldFromAShare) {
  EXPECT_THAT(InEnglish(PlausibilityHints(With("y_v", "1", -20, 45))),
              ElementsAre(HasSubstr("set unit = \"%\"")));
  EXPECT_THAT(InEnglish(PlausibilityHints(With("y_v", "%", -0.002, 0.0045))),
              ElementsAre(HasSubstr("set unit = \"1\"")));
}

TEST(Plausibility, AnOilTemperatureInTheWrongScaleIsNamed) {
  EXPECT_THAT(InEnglish(PlausibilityHints(With("T_oil", "K", 35, 52))),
              ElementsAre(HasSubstr("set unit = \"degC\"")));
  EXPECT_THAT(InEnglish(PlausibilityHints(With("T_oil", "degC", 583, 590))),
              ElementsAre(HasSubstr("set unit = \"K\"")));
}

TEST(Plausibility, APositionInMillimetresIsToldFromMetres) {
  EXPECT_THAT(InEnglish(PlausibilityHints(With("z", "m", 10, 200))),
              ElementsAre(HasSubstr("set unit = \"mm\"")));
  EXPECT_THAT(
      InGerman(PlausibilityHints(With("z", "m", 10, 200))),
      ElementsAre(HasSubstr("Hübe sind 1 mm bis 10 m lang. Sie sehen nach mm aus: unit = \"mm\" setzen")));
}

TEST(Plausibility, RightUnitsGiveNoHint) {
  EXPECT_THAT(InEnglish(PlausibilityHints(With("p_A", "Pa", 1e5, 210e5))), IsEmpty());
  EXPECT_THAT(InEnglish(PlausibilityHints(With("z", "m", 0.01, 0.2))), IsEmpty());
  EXPECT_THAT(InEnglish(PlausibilityHints(With("y_v", "1", -0.2, 0.45))), IsEmpty());
  EXPECT_THAT(InEnglish(PlausibilityHints(With("T_oil", "degC", 300, 330))), IsEmpty());
}

TEST(Plausibility, ASignalWithoutGoodReadingsExplainsWhyThereIsNoStroke) {
  CheckResult check = With("p_A", "Pa", 1e5, 210e5);
  check.driving.strokes = 0;
  check.time.rows = 1000;
  EXPECT_THAT(InEnglish(PlausibilityHints(check)), ElementsAre(HasSubstr("0 of 1000 readings are good")));
  check.signals[0].range.good = 900;
  EXPECT_THAT(InEnglish(PlausibilityHints(check)), IsEmpty());
}

TEST(Plausibility, ASignalThatNeverMovesIsNamed) {
  EXPECT_THAT(InEnglish(PlausibilityHints(With("U_v", "V", 2, 2))),
              ElementsAre(HasSubstr("one and the same reading")));
  EXPECT_THAT(InGerman(PlausibilityHints(With("U_v", "V", 2, 2))),
              ElementsAre(HasSubstr("ein und derselbe Wert in der ganzen Aufzeichnung")));
}

TEST(Plausibility, RowsThatWereWrittenTwiceAreTold) {
  CheckResult check = With("p_A", "Pa", 1e5, 210e5);
  check.pass.copied_rows = 369;
  EXPECT_THAT(InEnglish(PlausibilityHints(check)),
              ElementsAre(HasSubstr("369 rows repeat earlier rows to the last digit")));
}

TEST(Plausibility, ReadingsThatALoggerDrewAreTold) {
  CheckResult check = With("p_A", "Pa", 1e5, 210e5);
  check.pass.channels.resize(1);
  check.pass.channels[0].name = "p_A";
  check.pass.channels[0].rows = 45000;
  check.pass.channels[0].flagged[13] = 6191;
  EXPECT_THAT(InEnglish(PlausibilityHints(check)),
              ElementsAre(HasSubstr("p_A: 6191 readings lie on straight lines")));
  check.pass.channels[0].flagged[13] = 52;
  EXPECT_THAT(InEnglish(PlausibilityHints(check)), IsEmpty()) << "a ramp of a command does that";
}

TEST(Plausibility, AGateThatWouldOpenWithTheOtherSignSaysSo) {
  CheckResult check;
  check.conditions = {{"ddt(z) <= -4 mm/s", 0.0, 0.4}, {"y_v >= 0.04", 0.5, 0.1}};
  EXPECT_THAT(InEnglish(PlausibilityHints(check)),
              ElementsAre(testing::AllOf(HasSubstr("ddt(z)"), HasSubstr("scale = -1"))));
}

TEST(Plausibility, ASignThatKeepsConditionsOfTheGateApartIsTold) {
  CheckResult check;
  check.conditions = {{"ddt(z) <= -4 mm/s", 0.4, 0.4}, {"y_v >= 0.04", 0.5, 0.4}};
  check.gate = {0.0, {{"z", 0.38}, {"y_v", 0.38}}};
  EXPECT_THAT(InEnglish(PlausibilityHints(check)),
              ElementsAre(testing::AllOf(HasSubstr("38 %"), HasSubstr("(z, y_v)"), HasSubstr("scale = -1"))));
  check.gate.mirrored = {{"z", 0.0}, {"y_v", 0.0}};
  EXPECT_THAT(InEnglish(PlausibilityHints(check)), IsEmpty());
}

TEST(Plausibility, OneRamSpeedHidesALeakAndIsNamed) {
  CheckResult check;
  const Condition speed{.name = "speed",
                        .title = {"mean speed", "mittlere Geschwindigkeit"},
                        .signal = "z",
                        .unit = "m/s",
                        .vary = {"ram speed", "die Stößelgeschwindigkeit"},
                        .hides = {"a leak looks like flow", "ein Leck sieht aus wie Durchfluss"}};
  check.driving = {10, 0, {{speed, 0.049, 0.050}}, 313, 313};
  EXPECT_THAT(InEnglish(PlausibilityHints(check)), ElementsAre(HasSubstr("49 to 50 mm/s")));
  EXPECT_THAT(
      InGerman(PlausibilityHints(check)),
      ElementsAre(HasSubstr("mittlere Geschwindigkeit: 49 bis 50 mm/s; ein Leck sieht aus wie Durchfluss")));
  check.driving.ranges.front().high = 0.12;
  EXPECT_THAT(InEnglish(PlausibilityHints(check)), IsEmpty());
}

}  // namespace
}  // namespace hydroscope
