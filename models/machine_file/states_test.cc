#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "models/state_model.h"

namespace hydroscope {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

const std::string kHead = R"toml([signals]
q_in = { column = "q", unit = "l/min" }
level_2 = { column = "level", unit = "cm" }

[geometry]
A = { value = 15, unit = "cm2" }
)toml";
const std::string kStates = R"toml([states]
h_1 = { ddt = "(q_in - k_1*sqrt(max(h_1, 0)))/A", min = 0, max = 10, unit = "cm" }
h_2 = { ddt = "(k_1*sqrt(max(h_1, 0)) - k_2*sqrt(max(h_2, 0)))/A", initial = "level_2", min = 0, unit = "cm" }
)toml";
const std::string kRest = R"toml([outputs]
level_2 = "h_2"

[parameters]
k_1 = { start = 1e-4, min = 1e-5, max = 1e-3 }
k_2 = { start = 1e-4, min = 1e-5, max = 1e-3 }

[episodes]
seconds = 600
)toml";

std::string RefusalOf(const std::string& text) {
  const auto machine = ParseMachine(text, "tanks.toml");
  EXPECT_FALSE(machine) << text;
  return machine ? "" : machine.error().text;
}

TEST(StatesFile, IsReadInSiAndReadsBackEqual) {
  const auto machine = ParseMachine(kHead + kStates + kRest +
                                        "[[effect]]\nid = \"leak\"\nadds = { h_1 = \"-l*h_1\" }\nparameters "
                                        "= { l = { start = 0.01, min = 0, max = 1 } }\n",
                                    "tanks.toml");
  ASSERT_TRUE(machine) << machine.error().text;
  EXPECT_EQ(machine->model, "states");
  EXPECT_EQ(machine->states.states[0].initial, "estimate");
  EXPECT_DOUBLE_EQ(std::stod(machine->states.states[0].max), 0.1);
  EXPECT_EQ(machine->states.episode_seconds, 600);
  const auto again = ParseMachine(FormatMachine(*machine), "tanks.toml");
  ASSERT_TRUE(again) << again.error().text;
  EXPECT_EQ(*again, *machine);
  const auto model = BuildStateModel(*machine, {"leak"});
  ASSERT_TRUE(model) << model.error().text;
  EXPECT_EQ((*model)->parameters.back().name, "leak.l");
}

TEST(StatesFile, SaysHowMuchOlderOutputsAreThanInputs) {
  const auto late = [](const std::string& log) {
    const auto machine = ParseMachine(log + kHead + kStates + kRest, "tanks.toml");
    EXPECT_TRUE(machine) << machine.error().text;
    EXPECT_EQ(ParseMachine(FormatMachine(*machine), "tanks.toml").value(), *machine);
    return machine->log.outputs_late;
  };
  EXPECT_FALSE(late(""));
  EXPECT_EQ(late("[log]\noutputs_late = 0\n"), 0.0);
  EXPECT_EQ(late("[log]\noutputs_late = { value = -0.2, unit = \"ms\" }\n"), -2e-4);
}

TEST(StatesFile, AShaftIsASpeedAndAnUnknownInitialValueMayBeSoughtNearSomething) {
  const std::string speed = "n = { column = \"n\", unit = \"rpm\" }\n";
  const auto with = [&](const std::string& signal, const std::string& state, const std::string& shaft) {
    std::string text = kHead + kStates + kRest + "shaft = \"" + shaft + "\"\n";
    text.insert(text.find("q_in"), signal);
    const std::string initial = "initial = \"level_2\"";
    text.replace(text.find(initial), initial.size(), state);
    return text;
  };
  const auto machine = ParseMachine(with(speed, "near = \"level_2\"", "n"), "tanks.toml");
  ASSERT_TRUE(machine) << machine.error().text;
  EXPECT_EQ(machine->states.shaft, "n");
  EXPECT_EQ(machine->states.states[1].near, "level_2");
  EXPECT_EQ(*ParseMachine(FormatMachine(*machine), "tanks.toml"), *machine);
  EXPECT_THAT(RefusalOf(with("", "max = 9", "q_in")), AllOf(HasSubstr("shaft"), HasSubstr("rad/s")));
  EXPECT_THAT(RefusalOf(with(speed, "max = 9", "m")), HasSubstr("shaft"));
  EXPECT_THAT(RefusalOf(with(speed, "initial = \"level_2\", near = \"level_2\"", "n")), HasSubstr("near"));
}

TEST(StatesFile, LimitsOfParametersStandInTheirUnits) {
  const auto machine = ParseMachine(kHead +
                                        "w = { value = 1, unit = \"m/s\" }\n[states]\n"
                                        "h_2 = { ddt = \"(q_in - k_1*w)/A\", unit = \"cm\" }\n"
                                        "[outputs]\nlevel_2 = \"h_2\"\n[parameters]\n"
                                        "k_1 = { start = 1, max = 9, min = 0.1, unit = \"cm2\" }\n"
                                        "[monitor.k_1]\nunit = \"cm2\"\nalarm_high = 5\n",
                                    "tanks.toml");
  ASSERT_TRUE(machine) << machine.error().text;
  ASSERT_EQ(machine->monitors.size(), 1u);
  EXPECT_DOUBLE_EQ(machine->monitors[0].alarm_high.value(), 5e-4);
  const auto again = ParseMachine(FormatMachine(*machine), "tanks.toml");
  ASSERT_TRUE(again) << again.error().text;
  EXPECT_EQ(*again, *machine);
}

TEST(StatesFile, AMarkerOfEpisodesIsASignal) {
  const std::string rest = kRest + "marker = \"q_in\"\n";
  const auto machine = ParseMachine(kHead + kStates + rest, "tanks.toml");
  ASSERT_TRUE(machine) << machine.error().text;
  EXPECT_EQ(machine->episode_marker, "q_in");
  const auto again = ParseMachine(FormatMachine(*machine), "tanks.toml");
  ASSERT_TRUE(again) << again.error().text;
  EXPECT_EQ(*again, *machine);
  EXPECT_THAT(RefusalOf(kHead + kStates + kRest + "marker = \"q_im\"\n"),
              AllOf(HasSubstr("[episodes] marker"), HasSubstr("did you mean \"q_in\"?")));
  EXPECT_THAT(RefusalOf("[signals]\np = \"p\"\n[balance]\noutput = \"p\"\nterms = { a = \"1\" }\n"
                        "[episodes]\nseconds = 60\n"),
              HasSubstr("write max_stroke in [gate]"));
}

TEST(StatesFile, PointsAtTheCharacter) {
  EXPECT_THAT(RefusalOf(kHead + "[states]\nh_2 = { ddt = \"q_in - k_1*h_3\" }\n" + kRest),
              AllOf(HasSubstr("tanks.toml:8:27"), HasSubstr("did you mean \"h_2\"?"), HasSubstr("^")));
  EXPECT_THAT(RefusalOf(kHead + "[states]\nh_2 = { ddt = \"k_1 + k_2*ddt(q_in)\" }\n" + kRest),
              HasSubstr("make what changes a state"));
  EXPECT_THAT(RefusalOf(kHead + "[states]\nh_2 = { ddt = \"q_in\", unit = \"cm\" }\n" + kRest),
              AllOf(HasSubstr("an expression in m/s"), HasSubstr("m3/s")));
}

TEST(StatesFile, ADelayIsOfAnInputByANumberOrAParameter) {
  const auto with = [](const std::string& call) {
    return kHead + "[states]\nh_2 = { ddt = \"k_1*" + call + "\" }\n" + kRest;
  };
  EXPECT_TRUE(ParseMachine(with("delay(q_in, k_2)"), "tanks.toml"));
  EXPECT_TRUE(ParseMachine(with("delay(q_in, 0.2)"), "tanks.toml"));
  EXPECT_THAT(RefusalOf(with("delay(h_2, 0.2)")),
              AllOf(HasSubstr("tanks.toml:8:"), HasSubstr("is of an input")));
  EXPECT_THAT(RefusalOf(with("delay(q_in, h_2)")),
              HasSubstr("a delay is a number of seconds, or a parameter"));
  EXPECT_THAT(
      RefusalOf(kHead + "[states]\nh_2 = { ddt = \"k_1\", initial = \"delay(level_2, 1)\" }\n" + kRest),
      HasSubstr("has a place only in the equations"));
}

TEST(StatesFile, RefusesWhatCannotBeSimulated) {
  EXPECT_THAT(RefusalOf(kHead + "[states]\nh_2 = { initial = 3, unit = \"cm\" }\n" + kRest),
              HasSubstr("this state has no equation"));
  EXPECT_THAT(RefusalOf(kHead + kStates + "[outputs]\nlevel_2 = \"h_2 + 0.1*level_2\"\n"),
              HasSubstr("algebraic loop"));
  EXPECT_THAT(RefusalOf(kHead + "[states]\nh_2 = { ddt = \"q_in - k_1*level_2\" }\n" + kRest),
              HasSubstr("level_2 is an output, which the model gives itself"));
  EXPECT_THAT(RefusalOf(kHead + kStates), HasSubstr("section [outputs] is missing"));
  EXPECT_THAT(RefusalOf(kHead + kStates + "[outputs]\nlevel_1 = \"h_1\"\n"),
              HasSubstr("is no signal of [signals]"));
  EXPECT_THAT(RefusalOf(kHead + "[outputs]\nlevel_2 = \"1\"\n"), HasSubstr("[states]"));
}

TEST(StatesFile, AnInitialValueOutsideItsLimitsIsRefused) {
  EXPECT_THAT(
      RefusalOf(kHead + "[states]\nh_2 = { ddt = \"q_in/A\", initial = 12, max = 10, unit = \"cm\" }\n" +
                kRest),
      HasSubstr("a value between min and max"));
  EXPECT_THAT(
      RefusalOf(kHead + "[states]\nh_2 = { ddt = \"q_in/A\", min = 12, max = 10, unit = \"cm\" }\n" + kRest),
      HasSubstr("a limit below max"));
}

TEST(StatesFile, AKnownValueIsNoParameterAndItIsSaidWhereItStands) {
  EXPECT_THAT(
      RefusalOf(kHead + kStates + "[outputs]\nlevel_2 = \"h_2\"\n[parameters]\nk_1 = { value = 1e-4 }\n"),
      AllOf(HasSubstr("[parameters.k_1] value"), HasSubstr("what is known stands in [geometry]"),
            Not(HasSubstr("start is missing"))));
}

TEST(StatesFile, AParameterThatNothingReadsIsNamed) {
  const auto machine = ParseMachine(kHead + kStates + kRest + "\n", "tanks.toml");
  ASSERT_TRUE(machine);
  Machine with = *machine;
  with.states.parameters.push_back({"idle", 1, 0, 2, ""});
  const auto model = BuildStateModel(with, {});
  ASSERT_FALSE(model);
  EXPECT_THAT(model.error().text, HasSubstr("no equation reads the parameter idle"));
}

}  // namespace
}  // namespace hydroscope
