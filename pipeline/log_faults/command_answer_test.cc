#include "pipeline/log_faults/command_answer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "models/machine_kind.h"

namespace hydroscope {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// A spool that follows its command, and what a log makes of them.
struct SpoolLog {
  double of_spool = 1, of_command = 1;  ///< factors on readings
  double opening = 0.5;                 ///< largest
  int delay = 1;                        ///< rows
  double full = 12;                     ///< V, declared range of the command
  bool command = true;                  ///< is in the machine file

  CommandAnswers Seen() {
    machine = *LoadMachine(HYDROSCOPE_SOURCE_DIR "/machines/die_cushion.toml");
    SignalSpec& u = machine.signals[static_cast<std::size_t>(machine.SignalIndex("U_v"))];
    u.min = -full, u.max = full;
    SampleBlock rows;
    rows.Resize(machine.signals.size(), 20000);
    std::mt19937 random(5);
    std::normal_distribution<double> noise(0, 7e-5);
    const auto wanted = [this](int row) {
      return opening * std::sin(0.01 * row) * std::sin(0.0037 * row + 1) + 0.01 * std::sin(0.3 * row);
    };
    for (int row = 0; row < 20000; ++row) {
      const auto k = static_cast<std::size_t>(row);
      rows.time[k] = 0.002 * row;
      rows.signal[static_cast<std::size_t>(machine.SignalIndex("y_v"))][k] =
          of_spool * (1.005 * wanted(row - delay) + noise(random));
      rows.signal[static_cast<std::size_t>(machine.SignalIndex("U_v"))][k] = of_command * 10 * wanted(row);
    }
    if (!command) machine.signals.erase(machine.signals.begin() + machine.SignalIndex("U_v"));
    CommandAnswers answers(machine);
    answers.Observe(rows);
    return answers;
  }
  Machine machine;
};

std::vector<std::string> TextsOf(const std::vector<CommandAnswers::Fault>& faults) {
  std::vector<std::string> texts;
  for (const CommandAnswers::Fault& fault : faults) texts.push_back(fault.text.english);
  return texts;
}

TEST(CommandAnswers, OfAHealthyValveNothingIsSaid) {
  for (const int delay : {0, 1, 10})
    for (const double gain : {0.9, 1.0, 1.1}) {
      SpoolLog log{.of_spool = gain, .delay = delay};
      const CommandAnswers answers = log.Seen();
      EXPECT_THAT(answers.Against(0.5), IsEmpty());
      EXPECT_THAT(answers.Sizes(), IsEmpty());
    }
}

TEST(CommandAnswers, ASignalThatGoesAgainstItsCommandIsReversedAndTheGateTellsWhich) {
  SpoolLog command{.of_command = -1}, spool{.of_spool = -1};
  EXPECT_THAT(TextsOf(command.Seen().Against(0.5)),
              ElementsAre(AllOf(HasSubstr("go against each other"), HasSubstr("most likely U_v"),
                                HasSubstr("scale = -1"))));
  EXPECT_THAT(TextsOf(spool.Seen().Against(0.004)), ElementsAre(HasSubstr("most likely y_v")));
  EXPECT_THAT(TextsOf(spool.Seen().Against(0.02)), ElementsAre(testing::Not(HasSubstr("most likely"))));
  EXPECT_THAT(TextsOf(spool.Seen().Against()), ElementsAre(testing::Not(HasSubstr("most likely"))));
}

TEST(CommandAnswers, AFactorOfTwoBetweenTheTwoIsAWrongScale) {
  for (const double factor : {0.5, 2.0, 0.01, 100.0}) {
    SpoolLog command{.of_command = factor, .opening = 0.3}, spool{.of_spool = factor, .opening = 0.3};
    EXPECT_THAT(TextsOf(command.Seen().Sizes()), testing::Contains(HasSubstr("unit and scale"))) << factor;
    EXPECT_THAT(TextsOf(spool.Seen().Sizes()), testing::Contains(HasSubstr("unit and scale"))) << factor;
  }
}

TEST(CommandAnswers, ACommandOfAnotherFullRangeIsOneThatTheMachineFileDeclares) {
  SpoolLog five_volts{.of_command = 0.5};
  EXPECT_THAT(TextsOf(five_volts.Seen().Sizes()),
              ElementsAre(AllOf(HasSubstr("4.98 V"), HasSubstr("state it as max of U_v"))));
  five_volts.full = 5;
  EXPECT_THAT(five_volts.Seen().Sizes(), IsEmpty());
}

TEST(CommandAnswers, ASpoolThatMovesBeyondItsEndsHasAWrongScaleThoughNoCommandIsThere) {
  SpoolLog twice{.of_spool = 2, .opening = 0.9, .command = false};
  EXPECT_THAT(TextsOf(twice.Seen().Sizes()), ElementsAre(HasSubstr("% of where it ends")));
  SpoolLog right{.opening = 0.99, .command = false};
  EXPECT_THAT(right.Seen().Sizes(), IsEmpty());
}

TEST(CommandAnswers, ACommandThatRestsTellsNothing) {
  SpoolLog rests{.of_command = -1, .opening = 0.001};
  EXPECT_THAT(rests.Seen().Against(0.5), IsEmpty());
}

}  // namespace
}  // namespace hydroscope
