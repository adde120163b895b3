#include "alarms/feeds/modbus/register_image.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <sstream>

#include "alarms/feeds/modbus/register_map.h"
#include "core/registers.h"

namespace hydroscope {
namespace {

using namespace register_map;
using ::testing::HasSubstr;

std::uint64_t Whole(const RegisterImage& image, int at) {
  return DecodeUnsigned(image.registers().subspan(static_cast<std::size_t>(at), 2));
}
double Float(const RegisterImage& image, int at) {
  return DecodeRegisters(image.registers().subspan(static_cast<std::size_t>(at), 2), RegisterType::kFloat32,
                         WordOrder::kAbcd);
}
std::uint16_t Word(const RegisterImage& image, int at) {
  return image.registers()[static_cast<std::size_t>(at)];
}

TEST(AlarmNumbers, AreGivenInOrderOfAppearanceAndStay) {
  AlarmNumbers numbers;
  numbers.Add("press/a", "air");
  numbers.Add("press/b", "air");
  numbers.Add("press/a", "air");
  EXPECT_EQ(numbers.size(), 2);
  EXPECT_EQ(numbers.NumberOf("press/b", "air"), 2);
  EXPECT_EQ(numbers.NumberOf("press/b", "leak"), 0);
  EXPECT_EQ(numbers[2].first, "press/b");
}

TEST(RegisterImage, ShowsAnAxisWithItsParameters) {
  AxisPicture axis;
  axis.name = "cushion_1";
  axis.health.state = HealthState::kOutOfSpecification;
  axis.health.reason = HealthReason::kAlarms;
  axis.strokes = 70'000;
  TrendPoint point;
  point.time = 990;
  point.oil_temperature = 313.15;
  point.estimate = {"K", 1.5e9, 2e6, "Pa", 1, 980, EstimateReason::kNotExcited, 310.15};
  axis.estimates = {point};
  RegisterImage image;
  image.ShowAxis(2, axis, 1000);
  const int first = kFirstAxis + kAxisStride, k = first + kFirstParameter;
  EXPECT_EQ(Word(image, first + kHealth), 2);
  EXPECT_EQ(Word(image, kFirstHealth + kHealthStride + kReason), 1);
  EXPECT_EQ(Word(image, first + kStrokeAge), 10);
  EXPECT_EQ(Whole(image, first + kStrokes), 70'000u);
  EXPECT_NEAR(Float(image, first + kOilTemperature), 40, 1e-4);
  EXPECT_EQ(Word(image, first + kAxisName), 'c' << 8 | 'u');
  EXPECT_FLOAT_EQ(static_cast<float>(Float(image, k + kValue)), 1.5e9f);
  EXPECT_FLOAT_EQ(static_cast<float>(Float(image, k + kStd)), 2e6f);
  EXPECT_EQ(Word(image, k + kQuality), static_cast<int>(EstimateReason::kNotExcited));
  EXPECT_EQ(Word(image, k + kEstimateAge), 20);
  EXPECT_EQ(Word(image, k + kParameterName), 'K' << 8);
}

TEST(RegisterImage, SaysThatAParameterWasNeverIdentified) {
  AxisPicture axis;
  axis.estimates.resize(1);
  axis.estimates[0].estimate.last_excited = std::nan("");
  RegisterImage image;
  image.ShowAxis(1, axis, 1000);
  EXPECT_EQ(Word(image, kFirstAxis + kFirstParameter + kQuality), kNeverIdentified);
  EXPECT_EQ(Word(image, kFirstAxis + kFirstParameter + kEstimateAge), 65535);
}

TEST(RegisterImage, ShowsFlagsAndStateOfAnAlarm) {
  AlarmState alarm;
  alarm.id = "internal_leakage";
  alarm.severity = AlarmSeverity::kAlarm;
  alarm.active = true;
  alarm.acknowledged = false;
  alarm.raised_wall = 1.7e9;
  alarm.limit = 3;
  alarm.cause = {CauseKind::kNotKnown, {}};
  RegisterImage image;
  image.ShowAlarm(3, 1, alarm, 77);
  const int first = kFirstAlarm + 2 * kAlarmStride;
  EXPECT_EQ(Word(image, first + kFlags), kActive);
  EXPECT_EQ(kStateCodes[Word(image, first + kState)], "UNACK");
  EXPECT_EQ(Word(image, first + kSeverity), 2);
  EXPECT_EQ(Whole(image, first + kRaised), 1'700'000'000u);
  EXPECT_EQ(Whole(image, first + kAlarmSequence), 77u);
  EXPECT_EQ(Float(image, first + kAlarmLimit), 3);
  EXPECT_EQ(Word(image, kFirstCause + 2), 3) << "cause not known";
  alarm.cause = {CauseKind::kNotProven, {"internal_leakage", "supply_leakage"}};
  image.ShowAlarm(3, 1, alarm, 78);
  EXPECT_EQ(Word(image, kFirstCause + 2), 4) << "not proven, which is not named";
}

TEST(RegisterImage, KeepsTheNewestRowsInTheRingUnderTheirNumbers) {
  RegisterImage image;
  JournalRow row;
  row.wall = 1.7e9 + 0.25;
  row.event.event = "raised";
  row.event.state = "UNACK";
  for (row.sequence = 5; row.sequence <= kRingRecords + 10; ++row.sequence) image.ShowRow(row, 7, 2);
  image.ShowHead({}, 1.7e9);
  EXPECT_EQ(Whole(image, kNewest), kRingRecords + 10u);
  EXPECT_EQ(Whole(image, kOldest), 11u);
  EXPECT_EQ(Whole(image, kFirstRecord + 10 * kRecordWidth), kRingRecords + 10u);
  const int record = kFirstRecord + 11 * kRecordWidth;
  EXPECT_EQ(Whole(image, record), 11u);
  EXPECT_EQ(Word(image, record + kMilliseconds), 250);
  EXPECT_EQ(Word(image, record + kAlarmNumber), 7);
  EXPECT_EQ(kEventCodes[Word(image, record + kEvent)], "raised");
  EXPECT_EQ(kStateCodes[Word(image, record + kRecordState)], "UNACK");
}

TEST(RegisterImage, LeavesOutWhatTheMapHasNoRoomFor) {
  RegisterImage image;
  const std::vector<std::uint16_t> before(image.registers().begin(), image.registers().end());
  image.ShowAlarm(kMostAlarms + 1, 1, {}, 1);
  image.ShowAxis(kMostAxes + 1, {}, 1);
  image.ShowAxis(0, {}, 1);
  EXPECT_TRUE(std::equal(before.begin(), before.end(), image.registers().begin()));
}

TEST(RegisterImage, TheHeartbeatCountsPictures) {
  RegisterImage image;
  EXPECT_EQ(Word(image, kMagic), 0) << "no magic before the first picture";
  image.ShowHead({}, 1);
  image.ShowHead({}, 1);
  EXPECT_EQ(Word(image, kHeartbeat), 2);
  EXPECT_EQ(Word(image, kMapVersion), kVersion);
}

TEST(RegisterMapPage, NamesThePlacesAndCodesOfTheProgram) {
  std::ifstream file(std::string(HYDROSCOPE_SOURCE_DIR) + "/docs/register_map.md");
  std::stringstream page;
  page << file.rdbuf();
  for (const int place : {kFirstAxis, kAxisStride, kFirstAlarm, kAlarmStride, kFirstRecord, kRecordWidth,
                          kRingRecords, kMostAlarms, kMostAxes, kMostParameters, kAcknowledge})
    EXPECT_THAT(page.str(), HasSubstr(std::to_string(place)));
  for (std::size_t code = 0; code < kEventCodes.size(); ++code)
    EXPECT_THAT(page.str(), HasSubstr(fmt::format("{} {}", code, kEventCodes[code])));
  for (std::size_t code = 0; code < kStateCodes.size(); ++code)
    EXPECT_THAT(page.str(), HasSubstr(fmt::format("{} {}", code, kStateCodes[code])));
}

}  // namespace
}  // namespace hydroscope
