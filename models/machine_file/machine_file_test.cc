#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "models/machine.h"
#include "models/machine_file/format.h"

namespace hydroscope {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

Machine Load(const std::string& name) {
  const auto machine = LoadMachine(std::string(HYDROSCOPE_SOURCE_DIR) + "/machines/" + name);
  if (!machine) ADD_FAILURE() << machine.error().text;
  return machine.value_or(Machine{});
}

Machine Parse(const std::string& text) {
  const auto machine = ParseMachine(text, "press.toml");
  if (!machine) ADD_FAILURE() << machine.error().text;
  return machine.value_or(Machine{});
}

/// The smallest die cushion, to which tests append sections.
const std::string kCushion = R"([signals]
p_A = { column = "pA", unit = "bar" }
z = { column = "pos", unit = "mm" }
y_v = "spool"
[geometry]
A_A = 0.0125
dp_nom = { value = 35, unit = "bar", std = 0.5 }
)";

TEST(MachineFile, EveryMachineOfTheProjectLoadsAndReadsBackEqualAfterWriting) {
  int files = 0;
  for (const auto& entry :
       std::filesystem::directory_iterator(std::string(HYDROSCOPE_SOURCE_DIR) + "/machines")) {
    if (entry.path().extension() != ".toml" || entry.path().stem().string().ends_with("_rules")) continue;
    const auto machine = LoadMachine(entry.path().string());
    ASSERT_TRUE(machine) << machine.error().text;
    const auto again = ParseMachine(FormatMachine(*machine), "written");
    ASSERT_TRUE(again) << again.error().text << "\n" << FormatMachine(*machine);
    EXPECT_EQ(*machine, *again) << FormatMachine(*machine);
    ++files;
  }
  EXPECT_GE(files, 5);
}

TEST(MachineFile, ThePressIsInSiUnits) {
  const Machine press = Load("die_cushion.toml");
  EXPECT_EQ(press.model, "die_cushion");
  EXPECT_DOUBLE_EQ(press.Geometry("A_A")->value, 0.0125);
  EXPECT_DOUBLE_EQ(press.Geometry("dp_nom")->value, 35e5);
  EXPECT_DOUBLE_EQ(press.Geometry("p_t")->value, 0.0);
  EXPECT_FALSE(press.Geometry("A_B"));
  ASSERT_EQ(press.gate.bounds.size(), 2u);
  EXPECT_EQ(press.gate.bounds[1].signal, "z");
  EXPECT_TRUE(press.gate.bounds[1].rate);
  EXPECT_DOUBLE_EQ(*press.gate.bounds[1].max, -0.004);
  EXPECT_EQ(press.estimator, EstimatorSpec{});
  EXPECT_EQ(press.window, WindowSpec{});
  EXPECT_DOUBLE_EQ(*press.signals[press.SignalIndex("T_oil")].min, 243.15);
}

TEST(MachineFile, ThePublishedSettingsAreThoseOfThePublication) {
  const EstimatorSpec spec = Load("die_cushion_as_published.toml").estimator;
  EXPECT_EQ(spec.equation, EquationForm::kPublished);
  EXPECT_EQ(spec.form, EstimatorForm::kExponential);
  EXPECT_DOUBLE_EQ(spec.forgetting_factor, 0.998);
  EXPECT_DOUBLE_EQ(spec.initial_covariance, 500);
  EXPECT_DOUBLE_EQ(spec.initial_parameter, 1);
  EXPECT_FALSE(spec.initial_from_first_stroke);
  EXPECT_EQ(spec.moving_average, 31);
  EXPECT_EQ(spec.symmetrical_derivative, 25);
  EXPECT_DOUBLE_EQ(spec.update_period, 0.01);
}

TEST(MachineFile, SignalsKeepTheOrderOfTheFile) {
  const Machine machine = Parse(kCushion);
  EXPECT_EQ(machine.SignalIndex("p_A"), 0);
  EXPECT_EQ(machine.SignalIndex("z"), 1);
  EXPECT_EQ(machine.SignalIndex("y_v"), 2);
  EXPECT_EQ(machine.SignalIndex("p_B"), -1);
}

TEST(MachineFile, LimitsAndNoiseAreGivenInTheUnitOfTheSignal) {
  const Machine machine = Parse(
      "[signals]\nU_v = \"U\"\ny_v = \"y\"\n"
      "T = { column = \"T\", unit = \"degC\", min = -20, max = 80, noise = 0.5 }\n"
      "p = { column = \"p\", unit = \"bar\", max = { value = 25, unit = \"MPa\" }, noise = 2.2 }\n"
      "[machine]\nmodel = \"valve\"");
  const SignalSpec& temperature = machine.signals[2];
  EXPECT_DOUBLE_EQ(*temperature.min, 253.15);
  EXPECT_DOUBLE_EQ(*temperature.max, 353.15);
  EXPECT_DOUBLE_EQ(*temperature.noise_std, 0.5);
  EXPECT_DOUBLE_EQ(*machine.signals[3].max, 25e6);
  EXPECT_DOUBLE_EQ(*machine.signals[3].noise_std, 2.2e5);
}

TEST(MachineFile, KnownValuesCarryTheirUncertainty) {
  const Machine machine = Parse(kCushion);
  EXPECT_EQ(*machine.Geometry("dp_nom"), (KnownValue{35e5, 0.5e5}));
  EXPECT_EQ(*machine.Geometry("A_A"), (KnownValue{0.0125, 0}));
}

TEST(MachineFile, RatesInTheGateTakeAnyUnitOverSeconds) {
  const Machine machine = Parse(kCushion +
                                "[gate]\nconditions = { \"ddt(p_A)\" = { max = 20, unit = \"bar/s\" }, "
                                "\"ddt(z)\" = { min = -100, max = -4, unit = \"mm/s\" } }");
  EXPECT_DOUBLE_EQ(*machine.gate.bounds[0].max, 20e5);
  EXPECT_DOUBLE_EQ(*machine.gate.bounds[1].min, -0.1);
}

TEST(MachineFile, AGateThatSaysNothingOfTheSpoolKeepsItOffItsNull) {
  const auto bounds = [](const std::string& supply, const std::string& gate) {
    std::string text = kCushion;
    const auto at = text.find("[geometry]");
    return Parse(text.insert(at, supply) + gate).gate.bounds;
  };
  const std::string supply = "p_0 = { column = \"p_0\", unit = \"bar\" }\n";
  const std::string way = "[gate]\nconditions = { z = { min = 0.03 } }";
  ASSERT_EQ(bounds(supply, way).size(), 2u);
  EXPECT_EQ(bounds(supply, way)[1], (GateBound{"y_v", false, 0.02, {}, true}));
  EXPECT_EQ(bounds("", way)[1],
            (GateBound{"y_v", false, 0.02, {}, false}));  // p_0 drives what opens below the null
  EXPECT_EQ(bounds(supply, "[gate]\nconditions = { y_v = { min = 0.01 } }").size(), 1u);
  EXPECT_EQ(bounds(supply, "[gate]\nconditions = { y_v = { min = 0 } }").size(), 2u);
}

TEST(MachineFile, MonitorLimitsAreGivenInTheUnitOfTheSection) {
  const Machine machine = Parse(kCushion +
                                "[monitor.Q_vn]\nunit = \"l/min\"\nwarn_high = 115\n"
                                "alarm_high = { value = 0.002, unit = \"m3/s\" }");
  ASSERT_EQ(machine.monitors.size(), 1u);
  EXPECT_EQ(machine.monitors[0].parameter, "Q_vn");
  EXPECT_NEAR(*machine.monitors[0].warn_high, 115e-3 / 60, 1e-12);
  EXPECT_DOUBLE_EQ(*machine.monitors[0].alarm_high, 0.002);
}

TEST(MachineFile, AMachineOfTheUsersOwnIsABalanceOfExpressions) {
  const Machine machine = Parse(R"toml(
[signals]
F = {column="force", unit="N"}
x = {column="pos", unit="mm"}
p = {column="p", unit="bar"}
[balance]
output = "F"
unit = "N"
terms = { A = "p", c = "1" }        # F = A·p + c + missing
[[effect]]
id = "coulomb_friction"
german = "Reibung fester Größe"
terms = { F_c = "sign(ddt(x))" }
[[effect]]
id = "pressure_friction"
terms = { mu = "p*sign(ddt(x))" }
)toml");
  EXPECT_EQ(machine.name, "press");
  EXPECT_EQ(machine.model, "expressions");
  EXPECT_EQ(machine.balance.output, "F");
  EXPECT_THAT(machine.balance.terms, ElementsAre(TermSpec{"A", "p", ""}, TermSpec{"c", "1", ""}));
  ASSERT_EQ(machine.user_effects.size(), 2u);
  EXPECT_EQ(machine.user_effects[1].terms[0].expression, "p*sign(ddt(x))");
}

TEST(MachineFile, EffectsAddedToTheModelKeepTheirOrder) {
  const Machine machine =
      Parse("[machine]\nmodel_version = 3\neffects = [\"relief_valve\", \"internal_leakage\"]\n" + kCushion);
  EXPECT_THAT(machine.added_effects, ElementsAre("relief_valve", "internal_leakage"));
  EXPECT_EQ(machine.model_version, 3);
}

TEST(MachineFile, AnyNumberReadsBackExactlyAfterWriting) {
  Machine machine = Load("die_cushion.toml");
  double value = 0.1234567890123;
  for (int i = 0; i < 200; ++i) {
    value = value * 1.37 + 1e-9 / (i + 1);
    SignalSpec& temperature = machine.signals[machine.SignalIndex("T_oil")];
    temperature.max = 400 + value;
    temperature.noise_std = value;
    machine.geometry["dp_nom"] = {value, value / 3};
    machine.monitors = {{"Q_vn", {}, value / 7, {}, value * 1.1, value / 11}};
    machine.gate.bounds[1].max = -1 / value;
    const auto again = ParseMachine(FormatMachine(machine), "written");
    ASSERT_TRUE(again) << again.error().text;
    ASSERT_EQ(machine, *again) << FormatMachine(machine);
  }
}

TEST(MachineFile, EverySettingReadsBackAfterWriting) {
  Machine machine = Load("seal_friction.toml");
  machine.name = "press \"7\"\n\\ hall \x01 2";
  machine.model_version = 4;
  machine.added_effects = {"coulomb_friction"};
  machine.log = {',', '.', 3, false, true, "2", "ms", 0.0005, InputHold::kZero, -0.0002};
  machine.signals[0].scale = 3;
  machine.signals[0].offset = -1;
  machine.signals[0].required = false;
  machine.gate = {{{"p", true, 1.5, 2.5}, {"x", false, {}, 0.3}}, 0.7, 0.9};
  machine.window = {0.01, 0.5, 0.03};
  machine.estimator = {EquationForm::kPublished,
                       EstimatorForm::kExponential,
                       0.99,
                       30,
                       {{"A", 5}, {"c d", 6}},
                       100,
                       2,
                       false,
                       1e5,
                       0.5,
                       3,
                       11,
                       13,
                       0.02};
  machine.monitors = {{"A", 1, 2, 0.5, 3, 1.5}, {"my par", {}, 4, {}, {}, {}}};
  machine.valve = {"x", "p", 0.3};
  const auto again = ParseMachine(FormatMachine(machine), "written");
  ASSERT_TRUE(again) << again.error().text << FormatMachine(machine);
  EXPECT_EQ(machine, *again) << FormatMachine(machine);
}

TEST(MachineFile, AKindOfMachineSaysWhatItMayBeAskedFor) {
  const std::string asked =
      "[experiment]\nram_speed = { min = 20, max = 120, unit = \"mm/s\" }\nwarm_up = 15\n";
  const Machine press = Parse(kCushion + asked);
  EXPECT_EQ(press.experiment.Of("ram_speed"), (ExperimentSpec::Limits{0.02, 0.12}));
  EXPECT_EQ(press.experiment.Of("warm_up"), (ExperimentSpec::Limits{{}, 15.0}));
  EXPECT_EQ(press.experiment.Of("pressure"), ExperimentSpec::Limits{});
  EXPECT_EQ(Parse(FormatMachine(press)).experiment, press.experiment) << FormatMachine(press);
  const auto valve =
      ParseMachine("[machine]\nmodel = \"valve\"\n[signals]\nU_v = 1\ny_v = 2\n" + asked, "valve");
  ASSERT_FALSE(valve);
  EXPECT_THAT(valve.error().text, testing::HasSubstr("nothing can be proposed to record on a valve"));
}

TEST(MachineFile, NotesOfTheWriterAreCommentsThatDoNotChangeTheMachine) {
  const Machine machine = Load("die_cushion.toml");
  MachineNotes notes;
  notes.head = {"found in press.csv", "second\nline"};
  notes.signals["z"] = "falls during a stroke";
  notes.section["geometry"] = {"A_A = 1"};
  const std::string text = FormatMachine(machine, notes);
  EXPECT_THAT(text, HasSubstr("# found in press.csv\n# second line\n"));
  EXPECT_THAT(text, HasSubstr("# falls during a stroke\n"));
  EXPECT_THAT(text, HasSubstr("# A_A = 1\n"));
  EXPECT_EQ(Parse(text), machine);
}

}  // namespace
}  // namespace hydroscope
