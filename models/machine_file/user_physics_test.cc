#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "models/expressions/user_effect.h"
#include "models/model_structure.h"

namespace hydroscope {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

const std::string kSignals = R"([signals]
F = { column = "force", unit = "N" }
x = { column = "pos", unit = "mm" }
p = { column = "p", unit = "bar" }
)";

std::string RefusalOfSeal(const std::string& text) {
  const auto machine = ParseMachine(text, "seal.toml");
  EXPECT_FALSE(machine) << text;
  return machine ? "" : machine.error().text;
}

Machine ParseSeal(const std::string& text) {
  const auto machine = ParseMachine(text, "seal.toml");
  if (!machine) ADD_FAILURE() << machine.error().text;
  return machine.value_or(Machine{});
}

std::string Balance(const std::string& terms) {
  return kSignals + "[balance]\noutput = \"F\"\nterms = { " + terms + " }\n";
}

TEST(UserPhysicsFile, PointsAtTheCharacter) {
  EXPECT_EQ(
      RefusalOfSeal(Balance("A = \"p*sign(ddt(xx))\"")),
      "seal.toml:7:27: [balance.terms] A: unknown signal \"xx\"; did you mean \"x\"? known here: F, p, x\n"
      "    p*sign(ddt(xx))\n"
      "               ^");
}

TEST(UserPhysicsFile, DerivesAndChecksTheUnitOfAParameter) {
  const auto model = BuildModel(ParseSeal(Balance("A = \"p\", c = { expression = \"1\", unit = \"N\" }")));
  ASSERT_TRUE(model) << model.error().text;
  const auto derived = (*model)->derive(Eigen::Vector2d(5e-4, 1));
  EXPECT_EQ(derived[0].unit, "m2");
  EXPECT_EQ(derived[1].unit, "N");
  EXPECT_THAT(RefusalOfSeal(Balance("A = { expression = \"p\", unit = \"m3\" }")),
              AllOf(StartsWith("seal.toml:7: [balance]"), HasSubstr("A in \"m2\"")));
  EXPECT_THAT(RefusalOfSeal(Balance("A = { expression = \"p\", unit = \"mm2\" }")),
              HasSubstr("the SI unit \"m2\""));
  EXPECT_THAT(RefusalOfSeal(kSignals + "[balance]\noutput = \"F\"\nunit = \"Pa\"\nterms = { c = \"1\" }\n"),
              AllOf(StartsWith("seal.toml:7:"), HasSubstr("the SI unit of F")));
}

TEST(UserPhysicsFile, TakesStribecksFrictionWithASpeedThatIsFound) {
  const std::string effect =
      "[[effect]]\nid = \"stribeck\"\nterms = { F_s = \"sign(ddt(x))*exp(-abs(ddt(x))/v_s)\" }\n";
  const std::string found = "shape = { v_s = { min = 1, max = 100, unit = \"mm/s\" } }\n";
  EXPECT_TRUE(BuildModel(ParseSeal(Balance("A = \"p\"") + effect + found)));
  const std::string from_zero = "shape = { v_s = { min = 0, max = 100, unit = \"mm/s\" } }\n";
  EXPECT_THAT(RefusalOfSeal(Balance("A = \"p\"") + effect + from_zero), HasSubstr("exp of a rate"));
}

TEST(UserPhysicsFile, AnEffectHasOneParameterAndAnIdOfItsOwn) {
  const std::string base = Balance("A = \"p\"");
  EXPECT_THAT(RefusalOfSeal(base + "[[effect]]\nid = \"a\"\nterms = { k = \"x\", l = \"p\" }\n"),
              HasSubstr("one parameter"));
  const std::string cushion =
      "[signals]\np_A = { column = \"a\", unit = \"Pa\" }\nz = { column = \"z\", unit = \"m\" }\ny_v = "
      "\"y\"\n"
      "[geometry]\nA_A = 0.01\ndp_nom = 35e5\n";
  EXPECT_THAT(RefusalOfSeal(cushion + "[[effect]]\nid = \"internal_leakage\"\nterms = { k = \"p_A\" }\n"),
              HasSubstr("an effect of the library is called so"));
}

TEST(UserPhysicsFile, SaysWhatTheMachineMayBeAskedToDo) {
  const std::string base = Balance("A = \"p\"") + "[experiment]\n";
  const Machine machine =
      ParseSeal(base +
                "signals = { p = { min = 1, max = 7, unit = \"bar\" }, \"abs(ddt(x))\" = { min = 3, max = "
                "30, unit = \"mm/s\" } }\n");
  ASSERT_EQ(machine.experiment.signals.size(), 2u);
  EXPECT_EQ(machine.experiment.signals[0], (GateBound{"p", false, 1e5, 7e5, false}));
  EXPECT_EQ(machine.experiment.signals[1], (GateBound{"x", true, 0.003, 0.03, true}));
  EXPECT_EQ(ParseSeal(FormatMachine(machine)).experiment, machine.experiment);
  EXPECT_THAT(RefusalOfSeal(base + "signals = { q = { min = 1 } }\n"), HasSubstr("\"q\" is no signal"));
  EXPECT_THAT(RefusalOfSeal(base + "signals = { \"ddt(x)\" = { min = 1 } }\n"), HasSubstr("\"abs(ddt(x))\""));
  EXPECT_THAT(RefusalOfSeal(base + "warm_up = 10\n"), HasSubstr("for the die cushion"));
}

TEST(UserPhysicsFile, ConstantsFoundFromTheDataHaveLimits) {
  const std::string base =
      Balance("A = \"p\"") + "[[effect]]\nid = \"a\"\nterms = { k = \"max(x - c, 0)\" }\n";
  const Machine machine =
      ParseSeal(base + "shape = { c = { min = 5, max = 30, unit = \"mm\" } }\nmin = 0\ntypical = 2\n");
  ASSERT_EQ(machine.user_effects[0].shape.size(), 1u);
  EXPECT_DOUBLE_EQ(machine.user_effects[0].shape[0].max, 0.03);
  EXPECT_EQ(machine.user_effects[0].typical, 2.0);
  const auto again = ParseMachine(FormatMachine(machine), "again");
  ASSERT_TRUE(again) << again.error().text;
  EXPECT_EQ(*again, machine) << FormatMachine(machine);
  const auto model = BuildModel(machine);
  ASSERT_TRUE(model) << model.error().text;
  EXPECT_EQ((*model)->effect_shapes[0].size(), 6u);
  EXPECT_THAT(RefusalOfSeal(base + "shape = { c = { min = 5 } }\n"), HasSubstr("min and max are needed"));
  EXPECT_THAT(RefusalOfSeal(base + "shape = { x = { min = 5, max = 6 } }\n"),
              HasSubstr("no signal of that name"));
  EXPECT_THAT(RefusalOfSeal(base), HasSubstr("unknown signal \"c\""));
}

TEST(UserPhysicsFile, GeometryMayBeUsedByName) {
  const Machine machine = ParseSeal(Balance("c = \"1\", k = \"p*pi*d^2/4\"") +
                                    "derived = { bore = { expression = \"2*d*k\", unit = \"m\" } }\n"
                                    "[geometry]\nd = { value = 25, unit = \"mm\" }\n");
  const auto again = ParseMachine(FormatMachine(machine), "again");
  ASSERT_TRUE(again) << again.error().text;
  EXPECT_EQ(*again, machine);
  const auto model = BuildModel(machine);
  ASSERT_TRUE(model) << model.error().text;
  const auto derived = (*model)->derive(Eigen::Vector2d(7, 3));
  ASSERT_EQ(derived.size(), 3u);
  EXPECT_NEAR(derived[2].value, 2 * 0.025 * 3, 1e-12);
  EXPECT_NEAR(derived[2].gradient[1], 0.05, 1e-9);
  EXPECT_NEAR(derived[2].gradient[0], 0, 1e-12);
}

TEST(UserPhysicsFile, ABalanceWithoutARateHoldsSampleBySample) {
  EXPECT_TRUE((*BuildModel(ParseSeal(Balance("A = \"p\", f = \"sign(ddt(x))\""))))->level_form);
  EXPECT_FALSE((*BuildModel(ParseSeal(Balance("A = \"p\", d = \"ddt(x)\""))))->level_form);
  EXPECT_FALSE((*BuildModel(ParseSeal(Balance("A = \"p\", m = \"ddt(ddt(x))\""))))->level_form);
}

TEST(UserPhysicsFile, OwnEffectsStandBesideTheLibrary) {
  const Machine machine = ParseSeal(
      "[signals]\np_A = { column = \"a\", unit = \"Pa\" }\nz = { column = \"z\", unit = \"m\" }\ny_v = "
      "\"y\"\n"
      "p_B = { column = \"b\", unit = \"Pa\" }\nU = { column = \"u\", unit = \"V\" }\n"
      "[geometry]\nA_A = 0.01\ndp_nom = 35e5\n[[effect]]\nid = \"worn_bore\"\n"
      "terms = { leak_z = \"(p_A - p_B) * exp(-((z - 0.11)/0.02)^2)\" }\n[[effect]]\nid = \"b\"\nterms = { k "
      "= \"U\" }\n");
  const auto model = BuildModel(machine);
  ASSERT_TRUE(model) << model.error().text;
  const Effect& worn = *(*model)->effects[(*model)->effects.size() - 2];
  EXPECT_EQ(worn.id, "worn_bore");
  EXPECT_EQ(worn.unit, "m3/(s Pa)");
  EXPECT_EQ((*model)->channel_names.back(), "U");
  EXPECT_EQ((*model)->channel_source.back(), 4);
}

}  // namespace
}  // namespace hydroscope
