// `hydroscope replay` of the logs of a press with four cylinders: what all of them show together is told of
// the press, what one of them shows of that one.

#include <functional>

#include "machines/die_cushion/press_file_fixture.h"
#include "simulator/die_cushion/log_format.h"
#include "simulator/die_cushion/press.h"
#include "storage/alarm_journal.h"
#include "tests/command_line_fixture.h"

namespace hydroscope {
namespace {

using namespace command_line_test;
using testing::HasSubstr;

std::string Press() { return PressFile(R"("c1", "c2", "c3", "c4")", "", "degC"); }

/// Logs of a healthy press, and of the same press with a fault, simulated once.
class ReplayPress : public CommandLine {
 protected:
  void SetUp() override {
    CommandLine::SetUp();
    WriteText(File("press.toml"), Press());
    std::string rules = ReadText(std::string(HYDROSCOPE_SOURCE_DIR) + "/machines/die_cushion_rules.toml");
    rules.replace(rules.find("commissioning = 1500"), 20, "commissioning = 100");
    WriteText(File("press_rules.toml"), rules);
  }
  /// Four logs, FILE_1 ... FILE_4, of the same cylinders whatever `fault` does to each of them.
  void SimulateFour(const std::string& name, double seconds, std::uint64_t noise,
                    const std::function<void(int cylinder, PressOptions&)>& fault = {}) {
    PressOptions options;
    options.seconds = seconds;
    options.seed = 2024;
    options.noise_seed = noise;
    options.oil_start = 305.15;
    options.oil_end = 315.15;
    int cylinder = 0;
    for (PressOptions& cushion : FourCushions(options)) {
      ++cylinder;
      if (fault) fault(cylinder, cushion);
      PressGenerator generator(cushion);
      std::string text(kPressLogHeader);
      for (PressRow row; generator.Next(row);) AppendPressLine(row, text);
      WriteText(Log(name, cylinder), text);
    }
  }
  std::string Log(const std::string& name, int cylinder) const {
    return File(name + "_" + std::to_string(cylinder) + ".csv");
  }
  /// One call for each cylinder, in this order; the result of the last.
  nlohmann::json ReplayInOrder(const std::vector<int>& cylinders, const std::string& fault,
                               const std::string& db) {
    Ran ran;
    for (const int c : cylinders) {
      ran = Run({"replay", Log("healthy", c), Log(fault, c), "--axis", "c" + std::to_string(c), "-m",
                 File("press.toml"), "--db", File(db), "--json", "-"});
      EXPECT_EQ(ran.exit_code, 0) << ran.err;
    }
    return ran.Json();
  }
  /// "MACHINE ALARM STATE TEXT" of every alarm that stands.
  std::vector<std::string> Standing(const std::string& db) {
    std::vector<std::string> lines;
    const nlohmann::json listed = Run({"alarms", "--db", File(db), "list", "--json", "-"}).Json();
    for (const auto& a : listed.at("alarms"))
      lines.push_back(a.at("machine").get<std::string>() + " " + a.at("alarm").get<std::string>() + " " +
                      a.at("state").get<std::string>() + " " + a.at("raised_stroke").dump() + " " +
                      a.at("text").get<std::string>());
    return lines;
  }
};

TEST_F(ReplayPress, WhatAllAxesShowIsToldOfThePressInWhateverOrderTheyAreReplayed) {
  SimulateFour("healthy", 620, 1);
  SimulateFour("air", 200, 2, [](int, PressOptions& o) { o.machine.K *= 0.9; });
  const nlohmann::json last = ReplayInOrder({3, 1, 4, 2}, "air", "one_by_one.db");
  EXPECT_EQ(last.at("machine"), "press/c2");
  ASSERT_EQ(last.at("press").at("alarms").size(), 1u) << last.at("press");
  EXPECT_EQ(last.at("press").at("alarms")[0].at("alarm"), "supply_or_oil");
  const std::vector<std::string> standing = Standing("one_by_one.db");
  ASSERT_EQ(standing.size(), 5u);
  EXPECT_THAT(standing[0], testing::StartsWith("press supply_or_oil UNACK"));
  for (std::size_t c = 1; c <= 4; ++c)
    EXPECT_THAT(standing[c], testing::StartsWith("press/c" + std::to_string(c) + " entrained_air DSUPR"));

  ReplayInOrder({1, 2, 3, 4}, "air", "in_turn.db");
  EXPECT_THAT(Standing("in_turn.db"), testing::ElementsAreArray(standing));

  std::vector<std::string> words = {"replay", "-m", File("press.toml"), "--db", File("at_once.db"), "--json",
                                    "-",      "-r", File("press.html")};
  for (const char* name : {"healthy", "air"})
    for (int c = 1; c <= 4; ++c) words.push_back(Log(name, c) + "#c" + std::to_string(c));
  const Ran at_once = Run(words);
  EXPECT_EQ(at_once.exit_code, 0) << at_once.err;
  ASSERT_EQ(at_once.Json().at("machines").size(), 4u);
  EXPECT_EQ(at_once.Json().at("machines")[3].at("machine"), "press/c4");
  EXPECT_THAT(Standing("at_once.db"), testing::ElementsAreArray(standing));
  EXPECT_THAT(ReadText(File("press_c2.html")), HasSubstr("(supply_or_oil), "));

  const nlohmann::json again = Run(words).Json();  // nothing new: nothing is told
  for (const auto& machine : again.at("machines"))
    for (const auto& log : machine.at("logs")) EXPECT_EQ(log.at("status"), "already_replayed");
  const auto rows = [&](const char* db) {
    return AlarmJournal::OpenExisting(AlarmJournal::PathFor(File(db)))->Rows("").value().size();
  };
  EXPECT_EQ(rows("at_once.db"), rows("in_turn.db"));
}

TEST_F(ReplayPress, AWornSealOfOneCylinderIsToldOfThatOne) {
  SimulateFour("healthy", 620, 1);
  SimulateFour("worn", 200, 3, [](int cylinder, PressOptions& o) {
    if (cylinder == 2) o.effects = {{"internal_leakage", 4e-12, {}}};
  });
  const nlohmann::json last = ReplayInOrder({4, 3, 2, 1}, "worn", "press.db");
  EXPECT_TRUE(last.at("press").at("alarms").empty());
  const std::vector<std::string> standing = Standing("press.db");
  ASSERT_EQ(standing.size(), 1u) << testing::PrintToString(standing);
  EXPECT_THAT(standing[0], testing::StartsWith("press/c2 internal_leakage UNACK"));
}

TEST_F(ReplayPress, OneLogOfAllAxesGivesEachItsColumns) {
  SimulateFour("press", 60, 1);
  std::vector<std::string> lines;
  for (int c = 1; c <= 4; ++c) {
    std::istringstream log(ReadText(Log("press", c)));
    std::size_t k = 0;
    for (std::string line; std::getline(log, line); ++k) {
      const std::string rest = line.substr(line.find(',') + 1);
      if (c == 1) lines.push_back(line.substr(0, line.find(',')));
      std::stringstream fields(rest);
      for (std::string field; std::getline(fields, field, ',');)
        lines[k] += "," + (k == 0 ? "c" + std::to_string(c) + "." + field : field);
    }
  }
  std::string all;
  for (const std::string& line : lines) all += line + "\n";
  WriteText(File("all.csv"), all);
  std::string machine = Press();
  for (const char* signal : {"p_A", "p_B", "p_0", "z", "y_v", "U_v", "T_oil"}) {
    const std::string origin = std::string("dds = \"{axis}/") + signal + "\"";
    machine.insert(machine.find(origin), std::string("column = \"{axis}.") + signal + "\", ");
  }
  WriteText(File("all.toml"), machine);
  const Ran all_axes =
      Run({"replay", File("all.csv"), "-m", File("all.toml"), "--db", File("all.db"), "--json", "-"});
  EXPECT_EQ(all_axes.exit_code, 0) << all_axes.err;
  ASSERT_EQ(all_axes.Json().at("machines").size(), 4u);
  const Ran one = Run({"replay", Log("press", 3), "--axis", "c3", "-m", File("press.toml"), "--db",
                       File("one.db"), "--json", "-"});
  const auto parameters = all_axes.Json().at("machines")[2].at("parameters");
  EXPECT_EQ(parameters, one.Json().at("parameters"));
  EXPECT_EQ(Run({"fit", File("all.csv") + "#c3", "-m", File("all.toml")}).exit_code, 0);
  EXPECT_THAT(Run({"fit", File("all.csv"), "-m", File("all.toml")}).err, HasSubstr("all.csv#c1"));
}

TEST_F(ReplayPress, ALogOfNobodyKnowsWhichAxisIsRefusedWithWhatToWrite) {
  const std::string log = Simulate("left.csv", 20, 1);
  const std::vector<std::string> rest = {"-m", File("press.toml"), "--db", File("press.db")};
  const auto replay = [&](std::vector<std::string> words) {
    words.insert(words.begin(), "replay");
    words.insert(words.end(), rest.begin(), rest.end());
    return Run(words);
  };
  const Ran unsaid = replay({log});
  EXPECT_EQ(unsaid.exit_code, 3);
  EXPECT_THAT(unsaid.err, HasSubstr("left.csv#c1, or give --axis c1"));
  EXPECT_FALSE(std::filesystem::exists(File("press.db"))) << "nothing was begun";
  const Ran unknown = replay({log, "--axis", "c5"});
  EXPECT_EQ(unknown.exit_code, 3);
  EXPECT_THAT(unknown.err, HasSubstr("c1, c2, c3, c4"));
  const Ran missing = replay({File("gone.csv") + "#c1"});
  EXPECT_EQ(missing.exit_code, 3);
  EXPECT_THAT(missing.err, HasSubstr("gone.csv"));
}

}  // namespace
}  // namespace hydroscope
