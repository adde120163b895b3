#include "alarms/alarm_machine.h"

#include <gtest/gtest.h>

#include <cmath>

namespace hydroscope {
namespace {

using namespace alarm_machine;

/// One alarm above a limit of 1 with std 0.1: on after 2 strokes, off after 3, deadband 2 std.
class AlarmMachine : public ::testing::Test {
 protected:
  std::string Stroke(double value, AlarmSeverity severity = AlarmSeverity::kWarning) {
    ++now.stroke;
    now.time += 5;
    now.wall += 5;
    return Name(Observe(alarm, settings, {value, 0.1, 1.0, true, "1", severity, "text", 3, now.stroke}, now));
  }
  static std::string Name(const Events& events) { return events.empty() ? "" : events.front().event; }
  std::string State() const { return StateName(alarm); }
  /// Feeds a value `times` times; events joined.
  std::string Strokes(double value, int times) {
    std::string all;
    for (int k = 0; k < times; ++k) all += Stroke(value);
    return all;
  }

  AlarmSettings settings{2, 3, 2.0, false};
  AlarmState alarm;
  AlarmMoment now{0, 1000, 0, 313, 1, 1};
  AlarmUser user{"meier", "seen"};
};

struct Step {
  const char* what;  ///< value, "ack", "shelve", "unshelve", "suppress", "release", "out", "in", "reset"
  const char* event;
  const char* state;
};

TEST_F(AlarmMachine, ACommentChangesNothingButTheJournal) {
  alarm.active = true;
  alarm.acknowledged = false;
  alarm.value = alarm.std = alarm.limit = 1;
  const AlarmState before = alarm;
  const auto events = Comment(alarm, user, now);
  ASSERT_EQ(Name(events), "commented");
  EXPECT_EQ(events.front().comment, "seen");
  EXPECT_EQ(events.front().user, "meier");
  EXPECT_EQ(alarm, before);
  EXPECT_TRUE(Comment(alarm, {"meier", ""}, now).empty());
}

TEST_F(AlarmMachine, FollowsTheSequencesOfTheStandard) {
  const Step steps[] = {
      {"0.5", "", "NORM"},
      {"1.2", "", "NORM"},
      {"1.2", "raised", "UNACK"},
      {"ack", "acknowledged", "ACKED"},
      {"ack", "", "ACKED"},
      {"0.9", "", "ACKED"},  // inside the deadband
      {"0.5", "", "ACKED"},
      {"0.5", "", "ACKED"},
      {"0.5", "cleared", "NORM"},
      {"1.2", "", "NORM"},
      {"1.2", "raised", "UNACK"},
      {"0.5", "", "UNACK"},
      {"0.5", "", "UNACK"},
      {"0.5", "cleared", "RTNUN"},
      {"1.2", "", "RTNUN"},
      {"1.2", "raised", "UNACK"},
      {"shelve", "shelved", "SHLVD"},
      {"unshelve", "unshelved", "UNACK"},
      {"suppress", "suppressed", "DSUPR"},
      {"0.5", "", "DSUPR"},
      {"0.5", "", "DSUPR"},
      {"0.5", "cleared", "DSUPR"},
      {"release", "unsuppressed", "RTNUN"},
      {"out", "out_of_service", "OOSRV"},
      {"in", "in_service", "RTNUN"},
      {"ack", "acknowledged", "NORM"},
  };
  for (std::size_t i = 0; i < std::size(steps); ++i) {
    const std::string what = steps[i].what;
    std::string event;
    if (what == "ack")
      event = Name(Acknowledge(alarm, user, now));
    else if (what == "shelve")
      event = Name(Shelve(alarm, now.wall + 60, user, now));
    else if (what == "unshelve")
      event = Name(Unshelve(alarm, user, now));
    else if (what == "suppress")
      event = Name(Suppress(alarm, kSuppressedIdle, true, now));
    else if (what == "release")
      event = Name(Suppress(alarm, kSuppressedIdle, false, now));
    else if (what == "out")
      event = Name(SetOutOfService(alarm, true, user, now));
    else if (what == "in")
      event = Name(SetOutOfService(alarm, false, user, now));
    else
      event = Stroke(std::stod(what));
    EXPECT_EQ(event, steps[i].event) << "step " << i << " " << what;
    EXPECT_EQ(State(), steps[i].state) << "step " << i << " " << what;
  }
}

TEST_F(AlarmMachine, LatchedAlarmStaysUntilReset) {
  settings.latching = true;
  EXPECT_EQ(Strokes(1.2, 2), "raised");
  EXPECT_TRUE(Reset(alarm, user, now).empty()) << "the condition still holds";
  EXPECT_EQ(Strokes(0.1, 3), "cleared");
  EXPECT_EQ(State(), "LTUNK");
  Acknowledge(alarm, user, now);
  EXPECT_EQ(State(), "LTACK");
  EXPECT_EQ(Name(Reset(alarm, user, now)), "reset");
  EXPECT_EQ(State(), "NORM");
}

TEST_F(AlarmMachine, ShelfEndsWhenItsTimeIsOver) {
  Strokes(1.2, 2);
  Shelve(alarm, now.wall + 60, user, now);
  now.wall += 59;
  EXPECT_TRUE(Tick(alarm, now).empty());
  now.wall += 1;
  EXPECT_EQ(Name(Tick(alarm, now)), "unshelved");
  EXPECT_EQ(State(), "UNACK");
}

TEST_F(AlarmMachine, RiseInSeverityAsksForAnotherAcknowledgement) {
  Strokes(1.2, 2);
  Acknowledge(alarm, user, now);
  EXPECT_EQ(Stroke(5, AlarmSeverity::kAlarm), "escalated");
  EXPECT_EQ(State(), "UNACK");
  EXPECT_EQ(Stroke(5, AlarmSeverity::kAlarm), "");
}

TEST_F(AlarmMachine, OneStrokeBeyondTheLimitRaisesNothing) {
  for (int k = 0; k < 20; ++k) EXPECT_EQ(Stroke(k % 2 == 0 ? 3 : 0), "");
}

TEST_F(AlarmMachine, EventCarriesWhatTheJournalNeeds) {
  Stroke(1.2);
  ++now.stroke;
  const Events events =
      Observe(alarm, settings, {1.3, 0.1, 1, true, "1", AlarmSeverity::kAlarm, "seal", 7, 9}, now);
  ASSERT_EQ(events.size(), 1u);
  EXPECT_EQ(events[0].value, 1.3);
  EXPECT_EQ(events[0].limit, 1.0);
  EXPECT_EQ(events[0].first_stroke, 7);
  EXPECT_EQ(events[0].text, "seal");
  EXPECT_EQ(events[0].oil_temperature, 313);
  EXPECT_EQ(Name(Acknowledge(alarm, user, now)), "acknowledged");
}

}  // namespace
}  // namespace hydroscope
