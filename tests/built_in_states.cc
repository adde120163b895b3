// A kind of machine whose equations are built in: its file goes the same way as one that holds equations of its own. The kind
// stands here, in place of those of machines/, which must not know it.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "estimation/states/fit.h"
#include "models/closed_loop.h"
#include "models/machine_kind.h"
#include "models/state_effects.h"
#include "models/state_names.h"

namespace hydroscope {
namespace {

using ::testing::HasSubstr;

constexpr std::array<MachineInput, 3> kSignals = {{
    {.name = "pump_voltage", .si = "V", .required = true, .meaning = "voltage of the pump"},
    {.name = "level", .si = "m", .required = true, .meaning = "level of the lower tank"},
    {.name = "upper_level", .si = "m", .required = false, .meaning = "level of the upper tank"},
}};
constexpr std::array<MachineInput, 2> kGeometry = {{
    {.name = "area", .si = "m2", .required = true, .meaning = "area of a tank", .positive = true},
    {.name = "g", .si = "m/s2", .required = false, .meaning = "gravity", .otherwise = 9.81},
}};
constexpr std::array<MachineParameter, 2> kParameters = {{
    {.name = "outlet", .si = "m2", .meaning = "area of an outlet", .shown = "mm2", .factor = 1e6},
    {.name = "pump", .si = "m3/(s V)", .meaning = "gain of the pump"},
}};

StatesSpec Tanks(const Machine& machine) {
  StatesSpec spec;
  const double area = machine.Geometry("area").value_or(KnownValue{1}).value;
  spec.states = {{.name = "h_1",
                  .ddt = "(pump*pump_voltage - outlet*sqrt(2*g*max(h_1, 0)))/area",
                  .min = "0",
                  .unit = "m"},
                 {.name = "h_2",
                  .ddt = "outlet*(sqrt(2*g*max(h_1, 0)) - sqrt(2*g*max(h_2, 0)))/area",
                  .initial = "level",
                  .min = "0",
                  .unit = "m"}};
  spec.outputs = {{"level", "h_2"}, {"upper_level", "h_1"}};
  spec.parameters = {{.name = "outlet", .start = 0.01 * area, .min = 1e-4 * area, .max = area, .unit = "m2"},
                     {.name = "pump", .start = 1e-5, .min = 1e-7, .max = 1e-3, .unit = "m3/(s V)"}};
  return spec;
}

Effect Leak() {
  Effect e;
  e.id = "upper_leak";
  e.title = "The upper tank leaks";
  e.source = "Torricelli 1643";
  e.plain = "Look for water under the upper tank.";
  e.adds = {{"h_1", "-hole*sqrt(2*g*max(h_1, 0))/area"}};
  e.parameters = {{.name = "hole", .start = 1e-6, .min = 0, .max = 1e-3, .unit = "m2"}};
  return e;
}

Effect UpperZero() {
  Effect e;
  e.id = "upper_zero";
  e.title = "The upper sensor's zero is off";
  e.adds = {{"upper_level", "zero"}};
  e.parameters = {{.name = "zero", .start = 0, .min = -0.1, .max = 0.1, .unit = "m"}};
  return e;
}

std::vector<std::shared_ptr<const Effect>> Effects(const Machine&) {
  return {std::make_shared<Effect>(Leak()), std::make_shared<Effect>(UpperZero())};
}

const MachineKind kTanks = {
    .id = "tanks",
    .title = "two tanks",
    .signals = kSignals,
    .geometry = kGeometry,
    .parameters = kParameters,
    .output_unit = "m",
    .has_states = true,
    .states = Tanks,
    .words =
        [](const Machine&) {
          return MachineWords{
              {"level", "Stand"}, {"episode", "Episode"}, {"the pump", "die Pumpe"}, {}, false};
        },
    .effects = Effects};

std::string File(const std::string& more, const std::string& signals = "") {
  return R"([machine]
model = "tanks"
[signals]
pump_voltage = { column = "u", unit = "V" }
level = { column = "h", unit = "cm" }
)" + signals +
         R"([geometry]
area = { value = 100, unit = "cm2" }
)" + more;
}

std::string ProblemIn(const std::string& text) {
  const auto machine = ParseMachine(text, "tanks.toml");
  return machine ? "" : machine.error().text;
}

TEST(BuiltInStates, StandInTheMachineWithoutStandingInItsFile) {
  const auto machine = ParseMachine(File(""), "tanks.toml");
  ASSERT_TRUE(machine) << machine.error().text;
  EXPECT_EQ(machine->states.states.size(), 2u);
  ASSERT_EQ(machine->states.outputs.size(), 1u) << "an output that is not measured is left out";
  EXPECT_DOUBLE_EQ(machine->states.parameters[0].start, 1e-4);
  EXPECT_DOUBLE_EQ(machine->Geometry("g")->value, 9.81);
  EXPECT_EQ(OutputSi(*machine), "m");
}

TEST(BuiltInStates, TakeStartAndRangeFromTheFile) {
  const auto machine = ParseMachine(
      File("[parameters]\noutlet = { min = 1, max = 9, unit = \"cm2\" }\npump = { start = 2e-5 }\n"), "t");
  ASSERT_TRUE(machine) << machine.error().text;
  EXPECT_DOUBLE_EQ(machine->states.parameters[0].min, 1e-4);
  EXPECT_DOUBLE_EQ(machine->states.parameters[0].start, 1e-4) << "the kind's start is inside";
  EXPECT_DOUBLE_EQ(machine->states.parameters[1].start, 2e-5);
  EXPECT_DOUBLE_EQ(machine->states.parameters[1].max, 1e-3);
}

TEST(BuiltInStates, AreWrittenAsWhatTheFileSaysOtherwise) {
  const auto machine = ParseMachine(
      File("[parameters]\npump = { start = 2e-5 }\n[[effect]]\nid = \"own\"\nadds = { h_1 = \"-a*h_1\" }\n"
           "parameters = { a = { start = 1, min = 0, max = 2 } }\n"),
      "tanks.toml");
  ASSERT_TRUE(machine) << machine.error().text;
  const std::string text = FormatMachine(*machine);
  EXPECT_THAT(text, ::testing::Not(HasSubstr("[states]")));
  EXPECT_THAT(text, ::testing::Not(HasSubstr("outlet")));
  EXPECT_THAT(text, HasSubstr("[parameters]"));
  const auto again = ParseMachine(text, "tanks.toml");
  ASSERT_TRUE(again) << again.error().text << text;
  EXPECT_EQ(*again, *machine);
}

TEST(BuiltInStates, RefuseWhatTheKindDoesNotKnow) {
  EXPECT_THAT(ProblemIn(File("[parameters]\noulet = { start = 1 }\n")), HasSubstr("outlet"));
  EXPECT_THAT(ProblemIn(File("[parameters]\noutlet = { start = 3 }\n")), HasSubstr("between min and max"));
  EXPECT_THAT(ProblemIn(File("[parameters]\noutlet = { start = 1e-3, unit = \"m\" }\n")),
              HasSubstr("same quantity"));
  EXPECT_THAT(ProblemIn(File("[outputs]\nlevel = \"h_1\"\n")), HasSubstr("its own"));
  EXPECT_THAT(ProblemIn("[machine]\nmodel = \"tanks\"\n[signals]\nlevel = { column = \"h\", unit = \"cm\" }\n"
                        "[[effect]]\nid = \"own\"\nadds = { h_1 = \"-h_1\" }\n"),
              ::testing::AllOf(HasSubstr("voltage of the pump"), HasSubstr("area of a tank"),
                               ::testing::Not(HasSubstr("neither a state"))));
}

TEST(BuiltInStates, HaveTheEffectsOfTheirKindThenThoseOfTheFile) {
  const std::string own =
      "[[effect]]\nid = \"own\"\nadds = { h_1 = \"-a*h_1\" }\nparameters = { a = { start = 1 } }\n";
  const auto machine = ParseMachine(File(own), "tanks.toml");
  ASSERT_TRUE(machine) << machine.error().text;
  std::vector<std::string> ids;
  for (const Effect& e : StateEffectsOf(*machine)) ids.push_back(e.id);
  EXPECT_THAT(ids, ::testing::ElementsAre("upper_leak", "own")) << "the upper level is not measured";
  const auto with = ParseMachine(File(own, "upper_level = { column = \"h1\", unit = \"cm\" }\n"), "t");
  ASSERT_TRUE(with) << with.error().text;
  EXPECT_EQ(StateEffectsOf(*with).size(), 3u);
  EXPECT_THAT(ProblemIn(File("[[effect]]\nid = \"upper_leak\"\nadds = { h_1 = \"-h_1\" }\n")),
              HasSubstr("an effect of the library"));
  const auto wrong = BuildStateModel(*machine, {"upper_leek"});
  ASSERT_FALSE(wrong);
  EXPECT_THAT(wrong.error().text, HasSubstr("upper_leak"));
}

/// Levels under a pump that steps, by small Euler steps, so that the model's own integrator is not asked.
Episode Simulated(const Machine& machine, double outlet, double pump, double hole) {
  Episode episode;
  const int rows = 600;
  episode.signal.resize(rows, static_cast<Eigen::Index>(machine.signals.size()));
  double h1 = 0.1, h2 = 0.05;
  for (int row = 0; row < rows; ++row) {
    const double u = row / 100 % 2 == 0 ? 6 : 2;
    episode.time.push_back(row);
    episode.signal(row, machine.SignalIndex("pump_voltage")) = u;
    episode.signal(row, machine.SignalIndex("level")) = h2 + 1e-4 * std::sin(37.0 * row * row);
    for (int step = 0; step < 1000; ++step) {
      const double q1 = std::sqrt(2 * 9.81 * h1), q2 = std::sqrt(2 * 9.81 * h2);
      h1 += 1e-3 * (pump * u - (outlet + hole) * q1) / 0.01;
      h2 += 1e-3 * outlet * (q1 - q2) / 0.01;
    }
  }
  return episode;
}

TEST(BuiltInStates, AreFittedWithTheirEffects) {
  auto machine = ParseMachine("[log]\nhold = \"zero\"\n" + File(""), "tanks.toml");
  ASSERT_TRUE(machine) << machine.error().text;
  const double outlet = 1e-4, pump = 3e-5, hole = 4e-5;
  const std::vector<Episode> episodes = {Simulated(*machine, outlet, pump, hole)};
  const auto model = BuildStateModel(*machine, {"upper_leak"});
  ASSERT_TRUE(model) << model.error().text;
  const StateFit fit = FitStates(*model, episodes);
  ASSERT_TRUE(fit.solved()) << fit.failed.english;
  EXPECT_NEAR(fit.parameters[0], outlet, 0.02 * outlet);
  EXPECT_NEAR(fit.parameters[1], pump, 0.02 * pump);
  EXPECT_NEAR(fit.parameters[2], hole, 0.05 * hole);
}

}  // namespace

std::span<const MachineKind* const> MachineKinds() {
  static constexpr const MachineKind* kKinds[] = {&kTanks};
  return kKinds;
}

}  // namespace hydroscope
