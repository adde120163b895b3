#include "alarms/health.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "alarms/health_board.h"
#include "alarms/press_health.h"

namespace hydroscope {
namespace {

using testing::HasSubstr;

AlarmState Active(AlarmSeverity severity) {
  AlarmState alarm;
  alarm.id = "internal_leakage";
  alarm.active = true;
  alarm.severity = severity;
  return alarm;
}

char Judged(const std::vector<AlarmState>& alarms) {
  return JudgeHealth({.alarms = alarms, .has_reference = true, .not_judged = {}, .trouble = {}}).letter();
}

TEST(Health, TakesTheMostUrgentAlarmThatIsNotSuppressed) {
  const AlarmState warning = Active(AlarmSeverity::kWarning), alarm = Active(AlarmSeverity::kAlarm);
  AlarmState loss = Active(AlarmSeverity::kSignalLoss);
  EXPECT_EQ(Judged({}), '-');
  EXPECT_EQ(Judged({warning}), 'M');
  EXPECT_EQ(Judged({warning, alarm}), 'S');
  EXPECT_EQ(Judged({warning, alarm, loss}), 'F');
  loss.suppressed = kSuppressedValveCheck;
  EXPECT_EQ(Judged({loss}), '-');
  loss.out_of_service = true;
  EXPECT_EQ(Judged({loss}), 'C');
}

TEST(Health, CallsAlarmsByWhatTheyFoundAndThoseOfOldJournalsByTheirId) {
  AlarmState alarm = Active(AlarmSeverity::kWarning);
  EXPECT_EQ(JudgeHealth({.alarms = {alarm}, .has_reference = true}).text, "internal_leakage (warning)");
  alarm.words.finding = {"Press slower on Mondays",
                         "Presse montags langsamer"};  // the name of a rule of a user's own
  const Health standing = JudgeHealth({.alarms = {alarm}, .has_reference = true});
  EXPECT_EQ(standing.text, "Press slower on Mondays (warning)");
  EXPECT_EQ(standing.german, "Presse montags langsamer (Warnung)");
  alarm.out_of_service = true;
  EXPECT_EQ(JudgeHealth({.alarms = {alarm}, .has_reference = true}).text,
            "out of service: Press slower on Mondays");
}

TEST(Health, IsNeverGoodWhileTheHealthyMachineIsLearned) {
  const Health health =
      JudgeHealth({.alarms = {}, .learned = 19, .needed = 100, .not_judged = {}, .trouble = {}});
  EXPECT_EQ(health.letter(), 'C');
  EXPECT_EQ(health.reason, HealthReason::kLearning);
  EXPECT_THAT(health.text, HasSubstr("19 of 100"));
  EXPECT_EQ(health.needed, 100);
  const Health waits =
      JudgeHealth({.alarms = {}, .learned = 100, .needed = 100, .not_judged = {}, .trouble = {}});
  EXPECT_EQ(waits.letter(), 'C') << "freeze = \"command\"";
  EXPECT_THAT(waits.text, HasSubstr("hydroscope learn"));
}

TEST(Health, CallsEpisodesEpisodesInBothLanguages) {
  const auto judged = [&](const CountedWords& counted) {
    return JudgeHealth(
        {.alarms = {}, .learned = 19, .needed = 100, .not_judged = {}, .trouble = {}, .counted = counted});
  };
  EXPECT_EQ(judged({}).text, "learning the healthy machine, 19 of 100 strokes");
  EXPECT_EQ(judged({}).german, "die gesunde Maschine wird gelernt, 19 von 100 Hüben");
  EXPECT_EQ(judged(kEpisodes).text, "learning the healthy machine, 19 of 100 episodes");
  EXPECT_EQ(judged(kEpisodes).german, "die gesunde Maschine wird gelernt, 19 von 100 Episoden");
  EXPECT_EQ(Health{}.german, "noch wurde nichts beurteilt");
}

TEST(Health, IsNotGoodWhileStrokesComeThatCannotBeJudged) {
  const Health health = JudgeHealth(
      {.alarms = {}, .has_reference = true, .not_judged = {"oil too cold", "Öl zu kalt"}, .trouble = {}});
  EXPECT_EQ(health.letter(), 'C');
  EXPECT_EQ(health.reason, HealthReason::kStrokesNotJudged);
}

TEST(Health, ATroubleOfTheServiceIsAFailureOfEveryAxis) {
  HealthBoard board;
  EXPECT_EQ(board.Of("press/left").letter(), 'C') << "nobody has spoken of it";
  board.TellAxis("press/left", {HealthState::kGood, HealthReason::kJudgedGood, "judged", 0, 0});
  EXPECT_EQ(board.Of("press/left").letter(), '-');
  board.TellTrouble(HealthBoard::Part::kJudging, {HealthReason::kNotWatched, {"no rules", ""}});
  board.TellTrouble(HealthBoard::Part::kStoring, {HealthReason::kDiskFull, {"the disk is full", ""}});
  EXPECT_EQ(board.Of("press/left").letter(), 'F');
  EXPECT_EQ(board.Of("press/left").text, "the disk is full");
  board.TellTrouble(HealthBoard::Part::kStoring, {});
  EXPECT_EQ(board.Of("press/right").reason, HealthReason::kNotWatched);
  board.TellTrouble(HealthBoard::Part::kJudging, {});
  EXPECT_EQ(board.Of("press/left").letter(), '-');
}

TEST(Health, APressIsNotGoodWhileNoneOfItsAxesIsJudged) {
  const Health learning =
      JudgeHealth({.alarms = {}, .learned = 1, .needed = 100, .not_judged = {}, .trouble = {}});
  const Health good = JudgeHealth({.alarms = {}, .has_reference = true, .not_judged = {}, .trouble = {}});
  EXPECT_EQ(JudgePressHealth({}, {}, {learning, learning}).letter(), 'C');
  EXPECT_EQ(JudgePressHealth({}, {}, {learning, good}).letter(), '-');
  EXPECT_EQ(JudgePressHealth({Active(AlarmSeverity::kSignalLoss)}, {}, {learning}).letter(), 'F');
}

TEST(Health, IsReadAsItWasTold) {
  for (int code = 0; code <= static_cast<int>(HealthState::kFailure); ++code) {
    const auto state = static_cast<HealthState>(code);
    EXPECT_EQ(HealthStateOf(HealthLetter(state)), state);
  }
  for (int code = 0; code <= static_cast<int>(HealthReason::kNotWatched); ++code) {
    const auto reason = static_cast<HealthReason>(code);
    EXPECT_EQ(HealthReasonNamed(HealthReasonName(reason)), reason);
  }
  EXPECT_EQ(HealthStateOf('x'), HealthState::kFunctionCheck);
  EXPECT_EQ(HealthReasonNamed(""), HealthReason::kNothingKnown);
}

}  // namespace
}  // namespace hydroscope
