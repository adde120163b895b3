#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <sstream>

#include "tests/command_line_fixture.h"

namespace hydroscope::command_line_test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

/// Commands on logs of the simulated test cylinder.
class LoopCommand : public CommandLine {
 protected:
  int Code(const std::vector<std::string>& words) { return Run(words).exit_code; }
  nlohmann::json Json(const std::string& name) const { return nlohmann::json::parse(ReadText(File(name))); }
  void SimulateLoop(const std::string& name, const std::vector<std::string>& more) {
    std::vector<std::string> words = {"simulate", "test-cylinder", "--out",
                                      File(name), "--truth",       File(name + ".json")};
    words.insert(words.end(), more.begin(), more.end());
    const Ran ran = Run(words);
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
  }

  /// A copy of a log with other readings of I_v, in mA.
  void ReplaceCurrent(const std::string& from, const std::string& to,
                      const std::function<double(double)>& read) {
    std::istringstream rows(ReadText(File(from)));
    std::string row, text;
    std::getline(rows, row);
    ASSERT_EQ(row.substr(0, 12), "t,z_set,I_v,");
    for (text = row + "\n"; std::getline(rows, row); text += row + "\n") {
      const std::size_t begin = row.find(',', row.find(',') + 1) + 1, end = row.find(',', begin);
      row.replace(begin, end - begin, fmt::format("{:.6g}", read(std::stod(row.substr(begin, end - begin)))));
    }
    WriteText(File(to), text);
  }
  static std::string InOneLine(const std::string& text) {
    std::string out;
    for (const char c : text)
      if (c != '\n' && c != ' ')
        out += c;
      else if (!out.ends_with(' '))
        out += ' ';
    return out;
  }

  const std::string machine_ = std::string(HYDROSCOPE_SOURCE_DIR) + "/machines/test_cylinder.toml";
};

TEST_F(LoopCommand, FrfGivesTheTruthWithTheDocumentedKeysAndAPicture) {
  SimulateLoop("c.csv", {"--seconds", "40"});
  const Ran ran =
      Run({"frf", File("c.csv"), "-m", machine_, "--json", File("c_frf.json"), "--svg", File("c.svg")});
  ASSERT_EQ(ran.exit_code, 0) << ran.err;
  const auto json = Json("c_frf.json"), truth = Json("c.csv.json");
  for (const char* name : {"f_h", "zeta_h", "f_sv", "K_sv"}) {
    const double value = json["model"][name]["value"], true_value = truth["parameters"][name];
    EXPECT_NEAR(value, true_value, 3 * json["model"][name]["std"].get<double>()) << name;
  }
  for (const char* key :
       {"points", "left_out", "direct_bias", "needed_seconds", "segments", "warnings", "input_limit"})
    EXPECT_TRUE(json.contains(key)) << key;
  EXPECT_TRUE(json["points"][5].contains("direct_gain"));
  EXPECT_THAT(ran.out, HasSubstr("natural frequency of the oil column"));
  std::ifstream picture(File("c.svg"));
  std::string head(4, ' ');
  picture.read(head.data(), 4);
  EXPECT_EQ(head, "<svg");
}

TEST_F(LoopCommand, CheckSaysNothingOfEpisodesAndErrorsThatItDoesNotCount) {
  SimulateLoop("c.csv", {"--seconds", "10"});
  const auto json = Run({"check", File("c.csv"), "-m", machine_, "--json", "-"}).Json();
  for (const char* key : {"strokes", "rms_holdout", "noise_floor"})
    EXPECT_TRUE(json.at(key).is_null()) << key;
  for (const auto& signal : json.at("signals"))
    EXPECT_TRUE(signal.at("noise_std").is_null())
        << signal << ": what noise on the set point moves is no noise of a sensor";
  EXPECT_TRUE(json.at("hints").empty()) << json["hints"];
  const Ran fit = Run({"fit", File("c.csv"), "-m", machine_});
  EXPECT_EQ(fit.exit_code, 3);
  EXPECT_THAT(fit.err, HasSubstr("hydroscope frf LOG --machine FILE"));
}

TEST_F(LoopCommand, CheckNamesASignalThatStandsStill) {
  std::ofstream log(File("still.csv"));
  log << "t,z_set,I_v,z\n";
  for (int k = 0; k < 2000; ++k) log << k * 0.001 << "," << k % 7 << "," << k % 5 << ",3\n";
  log.close();
  const Ran told = Run({"check", File("still.csv"), "-m", machine_});
  EXPECT_EQ(told.exit_code, 4) << "nothing can be measured";
  EXPECT_THAT(told.out, HasSubstr("no response: z does not move in this log"));
  EXPECT_THAT(told.out, Not(HasSubstr("next:")));
  const auto json = Run({"check", File("still.csv"), "-m", machine_, "--json", "-"}).Json();
  EXPECT_THAT(json.at("hints").dump(), HasSubstr("z (column z): one and the same reading"));
  EXPECT_THAT(json.at("german").at("hints").dump(), HasSubstr("ein und derselbe Wert"));
}

TEST_F(LoopCommand, TheExchangeOfTheValveIsItsGainThatDoubledAndNothingElse) {
  SimulateLoop("old.csv", {"--seconds", "40"});
  SimulateLoop("new.csv", {"--seconds", "40", "--valve", "38", "--seed", "2"});
  const Ran ran =
      Run({"explain", File("new.csv"), "-m", machine_, "--since", File("old.csv"), "--json", File("x.json")});
  ASSERT_EQ(ran.exit_code, 0) << ran.err;
  const auto json = Json("x.json");
  EXPECT_EQ(json["verdict"], "named");
  EXPECT_EQ(json["set"], nlohmann::json({"valve_gain"}));
  EXPECT_NEAR(json["changes"]["valve_gain"]["value"], 2.02, 0.1);
  EXPECT_THAT(ran.out, HasSubstr("Nothing else changed"));
}

TEST_F(LoopCommand, AReversedPositionIsToldAndNotCompared) {
  SimulateLoop("c.csv", {"--seconds", "40"});
  std::string text = ReadText(machine_);
  const std::string column = "z     = { column = \"z\", unit = \"mm\"";
  ASSERT_NE(text.find(column), std::string::npos);
  text.replace(text.find(column), column.size(), column + ", scale = -1");
  WriteText(File("reversed.toml"), text);
  const Ran explained =
      Run({"explain", File("c.csv"), "-m", File("reversed.toml"), "--json", File("x.json")});
  const auto json = Json("x.json");
  EXPECT_EQ(json["verdict"], "unknown");
  EXPECT_EQ(json["reversed"], true);
  EXPECT_EQ(json["set"].size(), 0u);
  EXPECT_THAT(explained.out, HasSubstr("reversed between the records: check wiring and sign"));
  EXPECT_THAT(Run({"frf", File("c.csv"), "-m", File("reversed.toml")}).out,
              HasSubstr("z or I_v is reversed: K_sv has the other sign than that of the machine file"));
  EXPECT_THAT(Run({"replay", File("c.csv"), "-m", File("reversed.toml"), "--db", File("c.db")}).out,
              HasSubstr("z or I_v is reversed"));
}

TEST_F(LoopCommand, ACurrentWhoseReadingsEndIsToldByEveryCommand) {
  SimulateLoop("c.csv", {"--seconds", "20", "--sample-period", "1e-3"});
  ReplaceCurrent("c.csv", "cut.csv",
                 [](double milliamperes) { return std::clamp(milliamperes, -12.0, 12.0); });
  const std::string log = File("cut.csv"), db = File("cut.db");
  for (const auto& words :
       std::vector<std::vector<std::string>>{{"check", log, "-m", machine_},
                                             {"frf", log, "-m", machine_},
                                             {"explain", log, "-m", machine_},
                                             {"replay", log, "-m", machine_, "--db", db},
                                             {"trends", "--db", db},
                                             {"report", "--db", db, "--out", File("r.html")}})
    EXPECT_THAT(InOneLine(Run(words).out + ReadText(File("r.html"))),
                HasSubstr("I_v never reads more than 0.012 A"))
        << words[0];
  EXPECT_THAT(Run({"check", File("c.csv"), "-m", machine_}).out, Not(HasSubstr("never reads more")));
}

TEST_F(LoopCommand, ADeadBandIsToldByCheckAndReplay) {
  SimulateLoop("c.csv", {"--seconds", "40", "--sample-period", "1e-3"});
  // What the log says was commanded is the valve's input and a band beside it.
  ReplaceCurrent("c.csv", "band.csv",
                 [](double milliamperes) { return milliamperes + std::copysign(3.0, milliamperes); });
  const std::string log = File("band.csv");
  EXPECT_THAT(InOneLine(Run({"check", log, "-m", machine_}).out),
              HasSubstr("as with a dead band of 0.003 A"));
  EXPECT_THAT(InOneLine(Run({"replay", log, "-m", machine_, "--db", File("band.db")}).out),
              HasSubstr("as with a dead band of 0.003 A"));
}

TEST_F(LoopCommand, AWrongUnitIsRefusedAsByReplay) {
  SimulateLoop("c.csv", {"--seconds", "10"});
  std::string text = ReadText(machine_);
  text.replace(text.find("unit = \"mA\""), 11, "unit = \"A\"");
  WriteText(File("amperes.toml"), text);
  for (const char* command : {"frf", "explain"}) {
    const Ran ran = Run({command, File("c.csv"), "-m", File("amperes.toml")});
    EXPECT_EQ(ran.exit_code, 3) << command;
    EXPECT_THAT(ran.err, HasSubstr("set unit = \"mA\" for I_v")) << command;
  }
}

TEST_F(LoopCommand, APositionThatStandsIsLeftOutAndSaid) {
  SimulateLoop("c.csv", {"--seconds", "20", "--sample-period", "1e-3"});
  std::istringstream rows(ReadText(File("c.csv")));
  std::string stuck, row, held;
  for (int k = 0; std::getline(rows, row); ++k) {
    const std::size_t last = row.rfind(',');
    if (k == 8000) held = row.substr(last);
    stuck += (k > 8000 && k <= 12000 ? row.substr(0, last) + held : row) + "\n";
  }
  WriteText(File("stuck.csv"), stuck);
  for (const char* command : {"frf", "explain"})
    EXPECT_THAT(Run({command, File("stuck.csv"), "-m", machine_}).out,
                HasSubstr("4001 of 20000 rows left out (stuck 4001)"))
        << command;
  const Ran check = Run({"check", File("stuck.csv"), "-m", machine_});
  EXPECT_EQ(check.exit_code, 4);
  EXPECT_THAT(check.out, HasSubstr("flagged: 4001 x stuck, first at 7.999"));
  EXPECT_THAT(Run({"replay", File("stuck.csv"), "-m", machine_, "--db", File("c.db")}).out,
              HasSubstr("4001  values flagged stuck, z"));
}

TEST_F(LoopCommand, WithoutSinceTheReferencesOfTheMachineFileAreCompared) {
  SimulateLoop("c.csv", {"--seconds", "40"});
  const auto json = Run({"explain", File("c.csv"), "-m", machine_, "--json", "-"}).Json();
  EXPECT_EQ(json["verdict"], "adequate");
  EXPECT_TRUE(json["unseen"].empty()) << json["unseen"];
}

TEST_F(LoopCommand, ThreeSecondsHaveOneIntervalAndGiveNoAllClear) {
  SimulateLoop("c.csv", {"--seconds", "3"});
  const auto frf = Run({"frf", File("c.csv"), "-m", machine_, "--json", "-"}).Json();
  const auto explain = Run({"explain", File("c.csv"), "-m", machine_, "--json", "-"}).Json();
  for (const char* name : {"f_h", "zeta_h", "f_sv", "K_sv", "T_d"})
    EXPECT_NEAR(
        explain["parameters"][name]["after"]["std"].get<double>() / frf["model"][name]["std"].get<double>(),
        1, 1e-6)
        << name;
  EXPECT_EQ(explain["verdict"], "unknown");
  EXPECT_EQ(explain["poles_unknown"], true);
}

TEST_F(LoopCommand, BadInputAndWrongUseAreToldApart) {
  SimulateLoop("c.csv", {"--seconds", "5"});
  EXPECT_EQ(Code({"frf", File("c.csv"), "-m", machine_, "--method", "sine"}), 2);
  EXPECT_EQ(Code({"frf", File("absent.csv"), "-m", machine_}), 3);
  EXPECT_EQ(Code({"explain", File("c.csv"), "-m", machine_, "--since", File("absent.csv")}), 3);
  EXPECT_EQ(Code({"explain", File("c.csv"), File("c.csv"), "-m", machine_}), 2);
  EXPECT_EQ(Code({"simulate", "test-cylinder", "--out", File("x.csv"), "--f-h", "-3"}), 2);
  EXPECT_EQ(Code({"simulate", "test-cylinder", "--out", File("x.csv"), "--valve", "63"}), 2);
  EXPECT_EQ(Code({"fit", File("c.csv"), "-m", machine_}), 3);
  std::ofstream(File("bad.csv")) << "t,z_set,I_v\n0,1,2\n";
  const Ran bad = Run({"frf", File("bad.csv"), "-m", machine_});
  EXPECT_EQ(bad.exit_code, 3);
  EXPECT_THAT(bad.err, HasSubstr("no column 'z'"));
}

TEST_F(LoopCommand, ALimitOfTheMachineFileThatIsPassedIsSaid) {
  SimulateLoop("slow.csv", {"--seconds", "40", "--f-sv", "120"});
  EXPECT_THAT(Run({"frf", File("slow.csv"), "-m", machine_}).out, HasSubstr("below alarm_low 130"));
}

}  // namespace
}  // namespace hydroscope::command_line_test
