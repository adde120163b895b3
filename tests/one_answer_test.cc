#include <cmath>
#include <numbers>
#include <random>

#include "tests/command_line_fixture.h"

namespace hydroscope {
namespace {

using namespace command_line_test;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

/// One model, one answer: whatever a command concludes from the model of a machine file, all conclude.
class OneAnswer : public CommandLine {
 protected:
  nlohmann::json Json(std::vector<std::string> words) {
    words.insert(words.end(), {"--json", "-"});
    const Ran ran = Run(words);
    EXPECT_TRUE(ran.exit_code == 0 || ran.exit_code == 4) << ran.err;  // 4: a bad value was left out
    return ran.Json();
  }
  std::string Machine(const std::string& text) {
    WriteText(File("machine.toml"), text);
    return File("machine.toml");
  }
  std::string AddedTo(const std::string& machine, const std::string& log) {
    EXPECT_EQ(Run({"model", "add", "internal_leakage", log, "-m", machine}).exit_code, 0);
    return machine;
  }
  std::string Cushion() { return Machine(ReadText(kMachine)); }

  static void ExpectSame(const nlohmann::json& a, const nlohmann::json& b, const std::string& what) {
    ASSERT_TRUE(a.is_number() && b.is_number()) << what << ": " << a << " " << b;
    EXPECT_NEAR(a.get<double>(), b.get<double>(), 1e-6 * std::abs(a.get<double>())) << what;
  }
  /// Error, floor, verdict and parameters of a log in fit, check, compare and explain.
  void ExpectOneAnswer(const std::string& log, const std::string& machine) {
    const std::vector<std::string> of = {log, "-m", machine};
    const auto with = [&](const std::string& command) {
      std::vector<std::string> words = {command};
      words.insert(words.end(), of.begin(), of.end());
      return Json(words);
    };
    const nlohmann::json fit = with("fit"), check = with("check"), compare = with("compare"),
                         explain = with("explain");
    for (const char* key : {"rms_holdout", "noise_floor"}) {
      ExpectSame(fit[key], check[key], std::string("check ") + key);
      ExpectSame(fit[key], compare[key], std::string("compare ") + key);
      ExpectSame(fit[key], explain["base"][key], std::string("explain ") + key);
    }
    EXPECT_EQ(fit["verdict"], explain["verdict"]);
    EXPECT_EQ(check["verdict"], explain["verdict"]);
    EXPECT_EQ(compare["verdict"], explain["verdict"]);
    EXPECT_EQ(compare["odd_strokes"], explain["odd_strokes"]);
    EXPECT_EQ(compare["model_error_seen"].get<bool>(),
              explain["verdict"] != "adequate" || !explain["odd_strokes"].empty());
    for (const auto& [name, parameter] : fit["parameters"].items())
      for (const nlohmann::json* other : {&check, &compare, &explain["base"]}) {
        ASSERT_TRUE((*other)["parameters"].contains(name)) << name << other->dump(1);
        ExpectSame(parameter["value"], (*other)["parameters"][name]["value"], name);
        ExpectSame(parameter["std"], (*other)["parameters"][name]["std"], name + " std");
      }
  }
  /// The same of a database.
  void ExpectOneAnswerOf(const std::string& database) {
    const nlohmann::json compare = Json({"compare", "--db", database}),
                         explain = Json({"explain", "--db", database});
    ExpectSame(compare["rms_holdout"], explain["base"]["rms_holdout"], "rms_holdout");
    ExpectSame(compare["noise_floor"], explain["base"]["noise_floor"], "noise_floor");
    EXPECT_EQ(compare["verdict"], explain["verdict"]);
    EXPECT_EQ(compare["model_error_seen"].get<bool>(), explain["verdict"] != "adequate");
    EXPECT_GT(compare["rms_modelled"].get<double>(), 0);
  }
};

/// A voltage made of position, speed and an offset, and the friction-like effect its library knows.
std::string OwnMachine(const std::string& terms, const std::string& effects = "") {
  return "[machine]\nname = \"own\"\n[log]\ntime = { column = \"t\", unit = \"s\" }\n[signals]\n"
         "x = { column = \"x\", unit = \"m\", stuck_time = 0 }\nU = { column = \"U\", unit = \"V\", "
         "stuck_time = 0 }\n"
         "[gate]\nconditions = { \"abs(ddt(x))\" = { min = 1, unit = \"mm/s\" } }\n"
         "stroke_gap = 0.05\nmin_stroke = 0.1\n[window]\nblock = 0.02\nspan = 0.3\nhalf_width = 0.04\n"
         "[balance]\noutput = \"U\"\nunit = \"V\"\nterms = { " +
         terms + " }\n" + effects;
}
const char kFriction[] =
    "[[effect]]\nid = \"friction\"\ndescription = \"Friction\"\nterms = { f = \"sign(ddt(x))\" }\nunit = "
    "\"V\"\nmin = 0\n";

struct Voltage {
  double speed = 0.3, friction = 0, noise = 2e-3;
  double wander = 0;  ///< V, amplitude of an offset that comes and goes over 50 s
};
/// 30 s of a voltage 2 x + speed x' + friction sign(x') + 0.1.
std::string VoltageLog(const std::string& path, const Voltage& of) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  std::ofstream out(path);
  out << "t,x,U\n" << std::setprecision(9);
  constexpr double kSlow = 2 * std::numbers::pi * 0.7, kFast = 2 * std::numbers::pi * 1.9;
  for (int row = 0; row < 15'000; ++row) {
    const double t = 0.002 * row;
    const double x = 0.05 * std::sin(kSlow * t) + 0.02 * std::sin(kFast * t + 1);
    const double v = 0.05 * kSlow * std::cos(kSlow * t) + 0.02 * kFast * std::cos(kFast * t + 1);
    const double offset = of.wander * std::sin(2 * std::numbers::pi * t / 50);
    const double u = offset + 2 * x + of.speed * v + of.friction * (v > 0 ? 1 : -1) + 0.1;
    out << t << ',' << x + 1e-5 * normal(random) << ',' << u + of.noise * normal(random) << '\n';
  }
  return path;
}

TEST_F(OneAnswer, OfTheCushionWithAndWithoutAddedEffects) {
  const std::string machine = Cushion();
  const std::string log = Simulate("leak.csv", 60, 4, {"--effect", "internal_leakage=5e-12"});
  ExpectOneAnswer(log, machine);
  ASSERT_EQ(Run({"model", "add", "internal_leakage", log, "-m", machine}).exit_code, 0);
  ExpectOneAnswer(log, machine);
}

TEST_F(OneAnswer, TooFewStrokesForAVerdictAreNoAllClear) {
  const std::string machine = Cushion();
  const std::string log = Simulate("short.csv", 8, 1, {});
  const Ran compare = Run({"compare", log, "-m", machine});
  EXPECT_THAT(compare.out, HasSubstr("cannot be judged on these strokes: 2 strokes inside the gate"));
  EXPECT_THAT(compare.out, Not(HasSubstr("down to the sensor noise")));
  EXPECT_TRUE(Json({"compare", log, "-m", machine})["model_error_seen"].is_null());
  for (const char* command : {"fit", "check"}) {
    const Ran ran = Run({command, log, "-m", machine});
    EXPECT_THAT(ran.out, HasSubstr("was not judged: 2 strokes")) << command;
    EXPECT_THAT(ran.out, Not(HasSubstr("hydroscope explain"))) << command;
  }
}

TEST_F(OneAnswer, FitAndCheckShowTheSizesOfAddedEffects) {
  const std::string machine = Cushion();
  const std::string log = Simulate("leak.csv", 60, 4, {"--effect", "internal_leakage=5e-12"});
  EXPECT_THAT(Run({"fit", log, "-m", machine}).out, HasSubstr("the model misses"));
  ASSERT_EQ(Run({"model", "add", "internal_leakage", log, "-m", machine}).exit_code, 0);
  const nlohmann::json fit = Json({"fit", log, "-m", machine});
  EXPECT_EQ(fit["model_version"], 2);
  EXPECT_EQ(fit["effects"], nlohmann::json::array({"internal_leakage"}));
  const nlohmann::json& size = fit["parameters"]["internal_leakage.G"];
  EXPECT_NEAR(size["value"].get<double>(), 5e-12, 3 * size["std"].get<double>());
  EXPECT_LT(size["std"].get<double>(), 1e-12);
  const Ran ran = Run({"fit", log, "-m", machine});
  EXPECT_THAT(ran.out, HasSubstr("version 2"));
  EXPECT_THAT(ran.out, HasSubstr("internal_leakage.G"));
  EXPECT_THAT(ran.out, Not(HasSubstr("the model misses")));
  const nlohmann::json check = Json({"check", log, "-m", machine});
  EXPECT_EQ(check["model_version"], 2);
  EXPECT_EQ(check["parameters"]["internal_leakage.G"]["verdict"], "good") << check["parameters"].dump(1);
}

TEST_F(OneAnswer, CheckAdvisesACommandOnTheTerminalAndWhatToDoElsewhere) {
  const std::string log = Simulate("leak.csv", 90, 4, {"--effect", "internal_leakage=4e-12"});
  EXPECT_THAT(Run({"check", log, "-m", Cushion()}).out,
              HasSubstr("find what the model misses first: see 'hydroscope explain'"));
  const nlohmann::json k = Json({"check", log, "-m", Cushion()})["parameters"]["K"];
  EXPECT_EQ(k["advice"], "find what the model misses first");
  EXPECT_EQ(k["german"]["advice"], "erst finden, was dem Modell fehlt");
}

TEST_F(OneAnswer, OfAnOwnMachineOfLevels) {
  const std::string machine = Machine(OwnMachine("k = \"x\", c = \"1\"", kFriction));
  ExpectOneAnswer(VoltageLog(File("good.csv"), {.speed = 0}), machine);
  ExpectOneAnswer(VoltageLog(File("friction.csv"), {.speed = 0, .friction = 0.02}), machine);
}

TEST_F(OneAnswer, OfAnOwnMachineOfRatesWithAndWithoutItsEffect) {
  const std::string machine = Machine(OwnMachine("k = \"x\", d = \"ddt(x)\", c = \"1\"", kFriction));
  const std::string good = VoltageLog(File("good.csv"), {});
  ExpectOneAnswer(good, machine);
  const nlohmann::json compare = Json({"compare", good, "-m", machine});
  // The output is integrated in this form: its noise is a random walk, not white.
  EXPECT_NEAR(compare["noise_floor"].get<double>() / compare["rms_residual"].get<double>(), 1, 0.1);
  const std::string log = VoltageLog(File("friction.csv"), {.friction = 0.02});
  ExpectOneAnswer(log, machine);
  ASSERT_EQ(Run({"model", "add", "friction", log, "-m", machine}).exit_code, 0);
  ExpectOneAnswer(log, machine);
}

/// A parameter that follows from others must not stop the drift watch: it watches as many as there are regressors.
TEST_F(OneAnswer, TheDriftOfAMachineWithDerivedParametersIsWatched) {
  std::string text = OwnMachine("k = \"x\", d = \"ddt(x)\", c = \"1\"");
  const std::string machine = Machine(text + "derived = { time = { expression = \"d/k\", unit = \"s\" } }\n");
  const Ran ran =
      Run({"replay", VoltageLog(File("a.csv"), {}), "-m", machine, "--db", File("a.db"), "--json", "-"});
  ASSERT_EQ(ran.exit_code, 0) << ran.out << ran.err;
  EXPECT_TRUE(ran.Json()["parameters"].contains("time")) << ran.Json()["parameters"].dump(1);
  const Ran again = Run({"replay", File("a.csv"), "-m", machine, "--db", File("a.db")});
  EXPECT_THAT(again.out, Not(HasSubstr("not watched"))) << again.out;
  EXPECT_THAT(again.out, HasSubstr("learning the healthy machine"));
}

/// Strokes that hang together are not independent, and a replay must not take them for it either.
TEST_F(OneAnswer, ReplayIsNoSurerThanTheFitWhereStrokesHangTogether) {
  const std::string machine = Machine(OwnMachine("k = \"x\", c = \"1\""));
  const std::string log = VoltageLog(File("wander.csv"), {.speed = 0, .wander = 0.02});
  const nlohmann::json fit = Json({"fit", log, "-m", machine}),
                       explain = Json({"explain", log, "-m", machine}),
                       replay = Json({"replay", log, "-m", machine, "--db", File("wander.db")});
  ASSERT_NE(explain["interval_units"]["unit"], "stroke");
  for (const char* name : {"k", "c"})
    EXPECT_GE(replay["parameters"][name]["std"].get<double>(),
              0.9 * fit["parameters"][name]["std"].get<double>())
        << name;
}

TEST_F(OneAnswer, UnderColouredNoise) {
  const std::string log = Simulate("coloured.csv", 60, 4, {"--imperfection", "coloured_noise"}),
                    machine = Cushion();
  ExpectOneAnswer(log, machine);
  const Ran compare = Run({"compare", log, "-m", machine});
  EXPECT_THAT(compare.out, HasSubstr("nor is the noise of these sensors"));
  EXPECT_THAT(compare.out, Not(HasSubstr("NOT WHITE")));
}

/// What a missing effect takes away with it is no smaller noise.
TEST_F(OneAnswer, OnTheNoiseUnderColourWhereAnEffectIsMissing) {
  const std::string log = Simulate(
      "hidden.csv", 90, 4, {"--imperfection", "coloured_noise", "--effect", "internal_leakage=4e-12"});
  const nlohmann::json explain = Json({"explain", log, "-m", Cushion()});
  ASSERT_EQ(explain["verdict"], "named");
  ExpectSame(explain["base"]["noise_floor"], explain["noise_floor"], "noise floor");
  ExpectSame(Json({"fit", log, "-m", Cushion()})["noise_floor"], explain["noise_floor"],
             "noise floor of fit");
}

TEST_F(OneAnswer, OnTheNoiseUnderColourInLogDatabaseAndModel) {
  const std::string log = Simulate("hidden.csv", 90, 61,
                                   {"--effect", "internal_leakage=2e-12", "--imperfection",
                                    "coloured_noise=0.1,phi=0.8"}),
                    machine = Cushion(), db = File("a.db");
  const nlohmann::json explain = Json({"explain", log, "-m", machine});
  const double floor = explain["base"]["noise_floor"].get<double>();
  EXPECT_GT(explain["noise_scale"].get<double>(), 2);
  const auto expect = [&](const nlohmann::json& other, const std::string& what) {
    ASSERT_TRUE(other.is_number()) << what;
    EXPECT_NEAR(other.get<double>(), floor, 1e-3 * floor) << what;
  };
  expect(Json({"replay", log, "-m", machine, "--db", db})["noise_floor"], "replay");
  expect(Json({"compare", "--db", db})["noise_floor"], "compare of the database");
  expect(Json({"explain", "--db", db})["base"]["noise_floor"], "explain of the database");
  expect(Json({"model", "history", "-m", AddedTo(machine, log)})["versions"][0]["noise_floor"], "model add");
}

TEST_F(OneAnswer, WhereSomeStrokesAreOdd) {
  ExpectOneAnswer(Simulate("odd.csv", 90, 4, {"--imperfection", "intermittent_leakage"}), Cushion());
}

TEST_F(OneAnswer, AModelOfSomeStrokesIsNoAllClearOfAll) {
  const std::string log = Simulate("bad.csv", 60, 3, {"--imperfection", "bad_stretch"}), machine = Cushion();
  const Ran compare = Run({"compare", log, "-m", machine});
  EXPECT_THAT(compare.out,
              StartsWith("The model describes 11 of 12 strokes down to the sensor noise; stroke 6 (at"));
  EXPECT_THAT(compare.out, HasSubstr("WARNING: stroke 6 (at"));
  EXPECT_THAT(compare.out, HasSubstr("fitted to 11 of 12 strokes"));
  EXPECT_THAT(compare.out, Not(HasSubstr("NOT WHITE")));
  const nlohmann::json json = Json({"compare", log, "-m", machine});
  EXPECT_EQ(json["model_error_seen"], true);
  EXPECT_EQ(json["strokes_described"], 11);
  EXPECT_EQ(json["worst_stroke"], 6);
  ASSERT_EQ(Run({"explain", log, "-m", machine, "--report", File("bad.html")}).exit_code, 0);
  EXPECT_THAT(ReadText(File("bad.html")), HasSubstr("The model describes 11 of 12 strokes; stroke 6 (at"));
}

/// At a shape that is held the size alone looks surer than it is.
TEST_F(OneAnswer, ReplayIsNoSurerOfASizeThanItsShapeAllows) {
  const std::string log = Simulate("air.csv", 60, 4, {"--effect", "entrained_air=0.09"}), machine = Cushion(),
                    db = File("air.db");
  ASSERT_EQ(Run({"model", "add", "entrained_air", log, "-m", machine}).exit_code, 0);
  const nlohmann::json fit = Json({"fit", log, "-m", machine})["parameters"]["entrained_air.a"],
                       replay =
                           Json({"replay", log, "-m", machine, "--db", db})["parameters"]["entrained_air.a"];
  EXPECT_GE(replay["std"].get<double>(), 0.9 * fit["std"].get<double>());
  const nlohmann::json of_fit = Json({"fit", log, "-m", machine})["parameters"];
  const nlohmann::json summaries = Json({"trends", "--db", db})["summary"];
  for (const nlohmann::json& summary : summaries) {
    const std::string name = summary["parameter"];
    EXPECT_GE(summary["std"].get<double>(), 0.8 * of_fit[name]["std"].get<double>()) << name;
  }
  EXPECT_THAT(Run({"explain", log, "-m", kMachine}).out, HasSubstr(" at n "));
}

TEST_F(OneAnswer, OnALogThatIsHeldOut) {
  const std::string machine = Cushion();
  const std::string a = Simulate("a.csv", 60, 4),
                    b = Simulate("b.csv", 60, 4, {"--effect", "internal_leakage=5e-12"});
  const nlohmann::json fit = Json({"fit", a, b, "-m", machine, "--hold-out", "b.csv"}),
                       compare = Json({"compare", a, "-m", machine, "--hold-out", b}),
                       alone = Json({"fit", a, "-m", machine});
  EXPECT_EQ(fit["strokes"], alone["strokes"]);
  EXPECT_EQ(fit["held_out"], compare["held_out"]);
  EXPECT_EQ(fit["held_out"]["log"], b);
  EXPECT_GT(fit["held_out"]["rms"].get<double>(), 2 * fit["rms_holdout"].get<double>());
  EXPECT_EQ(Run({"fit", a, "-m", machine, "--hold-out", a}).exit_code, 2);
}

TEST_F(OneAnswer, OfADatabase) {
  const std::string machine = Cushion();
  const std::string healthy = Simulate("healthy.csv", 60, 3);
  ASSERT_EQ(Run({"replay", healthy, "-m", machine, "--db", File("a.db")}).exit_code, 0);
  ExpectOneAnswerOf(File("a.db"));
  const std::string log = Simulate("leak.csv", 60, 4, {"--effect", "internal_leakage=5e-12"});
  ASSERT_EQ(Run({"replay", log, "-m", machine, "--db", File("a.db")}).exit_code, 0);
  ExpectOneAnswerOf(File("a.db"));
}

/// A stroke in which a signal that only effects of the library need was bad must not count as modelled perfectly.
TEST_F(OneAnswer, ABadSignalOfTheLibraryMakesNoPerfectModel) {
  const std::string machine = Cushion();
  const std::string log =
      Simulate("leak.csv", 60, 4, {"--effect", "internal_leakage=5e-12", "--fault", "nan:p_B:12:3"});
  const Ran replayed = Run({"replay", log, "-m", machine, "--db", File("a.db")});
  ASSERT_TRUE(replayed.exit_code == 0 || replayed.exit_code == 4) << replayed.err;
  const nlohmann::json compare = Json({"compare", "--db", File("a.db")});
  EXPECT_EQ(compare["model_error_seen"], true) << compare.dump(1);
  for (const nlohmann::json& stroke : compare["per_stroke"])
    EXPECT_GT(stroke["rms_modelled"].get<double>(), 1) << stroke.dump();
}

TEST_F(OneAnswer, MoreStrokesAreNotAdvisedWhereTheModelMissesAnEffect) {
  const std::string log = Simulate("leak.csv", 90, 4, {"--effect", "internal_leakage=4.5e-12"});
  const Ran check = Run({"check", log, "-m", Cushion()});
  EXPECT_THAT(check.out, HasSubstr("find what the model misses first"));
  EXPECT_THAT(check.out, Not(HasSubstr("record at least")));
}

}  // namespace
}  // namespace hydroscope
