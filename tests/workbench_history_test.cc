#include <fmt/format.h>

#include <algorithm>

#include "tests/command_line_fixture.h"

namespace hydroscope {
namespace {

using namespace command_line_test;
using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

class WorkbenchHistory : public CommandLine {
 protected:
  void SetUp() override {
    CommandLine::SetUp();
    machine_ = File("press.toml");
    WriteText(machine_, ReadText(kMachine));
  }
  std::string Healthy(int seed) { return Simulate(std::to_string(seed) + ".csv", 60, seed); }
  std::string Leaking(int seed) {
    return Simulate("leak" + std::to_string(seed) + ".csv", 60, seed, {"--effect", "internal_leakage=5e-12"});
  }
  Ran Good(const std::vector<std::string>& words) {
    const Ran ran = Run(words);
    EXPECT_EQ(ran.exit_code, 0) << ran.err;
    return ran;
  }
  void Replay(const std::vector<std::string>& logs) {
    std::vector<std::string> words = {"replay"};
    words.insert(words.end(), logs.begin(), logs.end());
    words.insert(words.end(), {"-m", machine_, "--db", Db()});
    Good(words);
  }
  std::string Db() { return File("press.db"); }

  std::string machine_;
};

TEST_F(WorkbenchHistory, AddedTheErrorFallsAndRemovedTheBytesOfTheFileAreBack) {
  const std::string log = Leaking(4);
  const Ran add = Good({"model", "add", "internal_leakage", log, "-m", machine_, "--json", "-"});
  const nlohmann::json versions = add.Json()["versions"];
  ASSERT_EQ(versions.size(), 2u);
  EXPECT_LT(versions[1]["rms_holdout"].get<double>(), 0.95 * versions[0]["rms_holdout"].get<double>());
  EXPECT_LT(versions[1]["rms_holdout"].get<double>(), 1.1 * versions[1]["noise_floor"].get<double>());
  EXPECT_EQ(versions[1]["name"], "base + internal_leakage");
  EXPECT_TRUE(versions[0]["parameters"].contains("K"));
  EXPECT_NEAR(versions[1]["parameters"]["internal_leakage.G"]["value"].get<double>(), 5e-12, 1e-12);

  const Ran history = Good({"model", "history", "-m", machine_});
  EXPECT_THAT(history.out,
              AllOf(HasSubstr("base + internal_leakage"), HasSubstr("version 2"), HasSubstr("Q_vn")));
  EXPECT_EQ(Good({"model", "history", "-m", machine_, "--json", "-"}).Json()["versions"], versions);

  const Ran remove = Good({"model", "remove", "internal_leakage", "-m", machine_, "--json", "-"});
  EXPECT_TRUE(remove.Json()["restored"]);
  EXPECT_EQ(ReadText(machine_), ReadText(kMachine));
  EXPECT_THAT(ReadText(File("press.v2.toml")), HasSubstr("effects = [\"internal_leakage\"]"));
}

/// Filtered by a controller, noise goes on from row to row, which sums of products alone do not show.
TEST_F(WorkbenchHistory, WhatIsStoredOfALogWithColouredNoiseGetsTheVerdictOfTheLog) {
  const std::string log =
      Simulate("coloured.csv", 90, 5,
               {"--effect", "internal_leakage=6e-12", "--imperfection", "coloured_noise=1,phi=0.8,white=1"});
  Replay({log});
  const auto of_log = Good({"explain", log, "-m", machine_, "--json", "-"}).Json();
  const auto stored = Good({"explain", "--db", Db(), "--json", "-"}).Json();
  ASSERT_THAT(of_log["set"].get<std::vector<std::string>>(), Contains("internal_leakage"));
  EXPECT_THAT(stored["set"].get<std::vector<std::string>>(), Contains("internal_leakage"));
  EXPECT_GT(of_log["noise_scale"].get<double>(), 1.5);
  EXPECT_NEAR(stored["noise_floor"].get<double>(), of_log["noise_floor"].get<double>(),
              0.1 * of_log["noise_floor"].get<double>());
  const auto compared = Good({"compare", "--db", Db(), "--json", "-"}).Json();
  EXPECT_EQ(compared["verdict"], stored["verdict"]);
}

TEST_F(WorkbenchHistory, UndoTakesTheLastChangeBack) {
  Good({"model", "add", "internal_leakage", "-m", machine_});
  const std::string with_leak = ReadText(machine_);
  Good({"model", "add", "relief_valve", "-m", machine_});
  Good({"model", "undo", "-m", machine_});
  EXPECT_EQ(ReadText(machine_), with_leak);
  Good({"model", "undo", "-m", machine_});
  EXPECT_EQ(ReadText(machine_), ReadText(kMachine));
  const Ran again = Run({"model", "undo", "-m", machine_});
  EXPECT_EQ(again.exit_code, 3);
  EXPECT_THAT(again.err, HasSubstr("no version before"));
}

TEST_F(WorkbenchHistory, AModelWhoseSignalIsNotRecordedIsNotPromoted) {
  std::string text = ReadText(machine_);
  const std::size_t line = text.find("\np_B ");
  ASSERT_NE(line, std::string::npos);
  const std::string without = File("without.toml");
  WriteText(without, text.erase(line, text.find('\n', line + 1) - line));
  Good({"replay", Healthy(1), "-m", without, "--db", Db()});
  const std::string next = File("next.toml");
  Good({"model", "add", "internal_leakage", "-m", machine_, "--out", next});
  const Ran refused = Run({"model", "promote", "-m", next, "--db", Db()});
  EXPECT_EQ(refused.exit_code, 3);
  EXPECT_THAT(refused.err, AllOf(HasSubstr("cannot be watched with this model"), HasSubstr("p_B")));
  const nlohmann::json stored = Good({"model", "history", "--db", Db(), "--json", "-"}).Json()["stored"];
  ASSERT_EQ(stored.size(), 1u) << "nothing was stored";
  EXPECT_FALSE(stored[0]["in_force"]) << "nothing was promoted";
}

TEST_F(WorkbenchHistory, APromotionStandsInTheJournal) {
  Replay({Healthy(1)});
  const std::string next = File("next.toml");
  Good({"model", "add", "internal_leakage", "-m", machine_, "--out", next});
  Good({"model", "promote", "-m", next, "--db", Db(), "--user", "anna", "--comment", "the seal leaks"});
  const nlohmann::json journal = Good({"alarms", "--db", Db(), "journal", "--json", "-"}).Json();
  nlohmann::json promoted;
  for (const nlohmann::json& row : journal["journal"])
    if (row["event"] == "model_promoted") promoted = row;
  ASSERT_TRUE(promoted.is_object());
  EXPECT_EQ(promoted["user"], "anna");
  EXPECT_EQ(promoted["comment"], "the seal leaks");
  EXPECT_THAT(promoted["text"].get<std::string>(), HasSubstr("internal_leakage"));
}

TEST_F(WorkbenchHistory, APromotedModelIsTheOneOfLaterReplays) {
  Replay({Healthy(1)});
  const std::string next = File("next.toml");
  Good({"model", "add", "internal_leakage", "-m", machine_, "--out", next});
  Good({"model", "promote", "-m", next, "--db", Db()});
  Replay({Leaking(2)});  // with the machine file as it was
  const nlohmann::json points =
      Good({"trends", "--db", Db(), "--parameter", "internal_leakage.G", "--json", "-"}).Json()["points"];
  ASSERT_FALSE(points.empty());
  for (const nlohmann::json& point : points) EXPECT_EQ(point["run"], 2) << "what was replayed before stays";
  EXPECT_NEAR(points.back()["value"].get<double>(), 5e-12, 2.5e-12);

  const nlohmann::json stored = Good({"model", "history", "--db", Db(), "--json", "-"}).Json()["stored"];
  ASSERT_EQ(stored.size(), 2u);
  EXPECT_FALSE(stored[0]["in_force"]);
  EXPECT_TRUE(stored[1]["in_force"]);
  EXPECT_THAT(stored[1]["effects"], ElementsAre("internal_leakage"));

  Good({"model", "promote", "--db", Db(), "--version", "1"});
  Replay({Healthy(3)});
  const nlohmann::json later =
      Good({"trends", "--db", Db(), "--parameter", "internal_leakage.G", "--json", "-"}).Json()["points"];
  EXPECT_EQ(later.size(), points.size()) << "the old model is back";
  const Ran again = Good({"replay", File("1.csv"), File("leak2.csv"), File("3.csv"), "-m", machine_, "--db",
                          Db(), "--json", "-"});
  for (const nlohmann::json& log : again.Json()["logs"]) EXPECT_EQ(log["status"], "already_replayed");
}

TEST_F(WorkbenchHistory, TheDatabaseAloneSaysWhatAppearedHalfWay) {
  Replay({Healthy(1), Healthy(2), Leaking(3), Leaking(4)});
  const Ran change = Good({"explain", "--db", Db(), "--since", "run:3", "--json", "-"});
  const nlohmann::json json = change.Json();
  EXPECT_THAT(json["set"], Contains("internal_leakage")) << json.dump(1);
  EXPECT_THAT(json["change"]["appeared"], Contains("internal_leakage"));
  EXPECT_EQ(json["change"]["verdict_before"], "adequate");
  EXPECT_EQ(json["change"]["before"]["machines"][0]["last"].get<int>() + 1,
            json["change"]["since"].get<int>());
  for (const char* name : {"K", "V0", "Q_vn", "y_0"})
    EXPECT_TRUE(json["change"]["parameters"][name].contains("before")) << name;
  EXPECT_THAT(Good({"explain", "--db", Db(), "--since", "run:3"}).out, HasSubstr("internal_leakage"));

  const nlohmann::json before = Good({"explain", "--db", Db(), "--to", "run:3", "--json", "-"}).Json();
  EXPECT_EQ(before["verdict"], "adequate");
  const nlohmann::json after = Good({"explain", "--db", Db(), "--from", "run:3", "--json", "-"}).Json();
  EXPECT_THAT(after["set"], Contains("internal_leakage"));
  EXPECT_EQ(before["strokes"].get<int>() + after["strokes"].get<int>(),
            Good({"explain", "--db", Db(), "--whole", "--json", "-"}).Json()["strokes"].get<int>());
}

TEST_F(WorkbenchHistory, StrokesThatHoldAChangeAreNotExplainedAsOneUnasked) {
  Replay({Healthy(1), Healthy(2), Leaking(3), Leaking(4)});
  const Ran whole = Good({"explain", "--db", Db(), "--whole", "--json", "-"});
  EXPECT_TRUE(whole.Json()["change_found"].is_null());
  const nlohmann::json found = Good({"explain", "--db", Db(), "--json", "-"}).Json();
  ASSERT_TRUE(found["change_found"].is_object()) << found.dump(1);
  const auto change = Good({"explain", "--db", Db(), "--since", "run:3", "--json", "-"}).Json()["change"];
  EXPECT_NEAR(found["change_found"]["since"].get<double>(), change["since"].get<double>(), 6);
  EXPECT_THAT(found["change"]["appeared"], Contains("internal_leakage"));
  const std::string text = Good({"explain", "--db", Db()}).out;
  EXPECT_THAT(text, AllOf(HasSubstr("These strokes hold a change"), HasSubstr("--whole")));
  Good({"report", "--db", Db(), "--out", File("page.html")});
  EXPECT_THAT(
      ReadText(File("page.html")),
      AllOf(
          HasSubstr("These strokes hold a change"),
          HasSubstr(
              "Not proven: the model lacks this, or a relative of it: Internal leakage past the piston seal"),
          Not(HasSubstr("no effect of the library explains"))));

  const nlohmann::json after = Good({"explain", "--db", Db(), "--from", "run:3", "--json", "-"}).Json();
  EXPECT_TRUE(after["change_found"].is_null()) << "all of them leak";
}

TEST_F(WorkbenchHistory, ALeakingMachineIsNotLearnedAsTheHealthyOne) {
  Replay({Simulate("worn.csv", 650, 1,
                   {"--effect", "internal_leakage=5e-12"})});  // a reference needs 100 strokes
  const Ran leaking = Run({"learn", "--db", Db(), "-m", machine_, "--json", File("learned.json")});
  EXPECT_EQ(leaking.exit_code, 3);
  EXPECT_THAT(leaking.err, AllOf(HasSubstr("internal_leakage"), HasSubstr("--force")));
  const auto refused = nlohmann::json::parse(ReadText(File("learned.json")))["refused"];
  ASSERT_EQ(refused.size(), 1u);
  EXPECT_EQ(refused[0]["doubts"][0]["kind"], "effect");
  const Ran forced = Good({"learn", "--db", Db(), "-m", machine_, "--force", "--json", "-"});
  EXPECT_EQ(forced.Json()["learned"][0]["doubts"][0]["kind"], "effect");
  const Ran alarms = Good({"alarms", "--db", Db(), "list", "--json", "-"});
  EXPECT_THAT(alarms.out, HasSubstr("doubtful_reference"));
}

/// Of a sensor that read too high for a while the model describes all strokes but those.
TEST_F(WorkbenchHistory, ABadStretchIsNotLearnedAsPartOfTheHealthyMachine) {
  Replay({Simulate("bad.csv", 650, 5, {"--imperfection", "bad_stretch"})});
  const Ran learned = Run({"learn", "--db", Db(), "-m", machine_});
  EXPECT_EQ(learned.exit_code, 3);
  EXPECT_THAT(learned.err, HasSubstr("a few of them differ from the others"));
}

/// A leak that begins small and grows from log to log: no two levels of a parameter, no effect of one size.
TEST_F(WorkbenchHistory, WhereAGrowingLeakBeginsIsFoundInTheErrorAndItIsNotLearned) {
  std::vector<std::string> logs;
  for (int day = 0; day < 8; ++day)
    logs.push_back(
        Simulate(fmt::format("day{}.csv", day), 60, 1 + day,
                 {"--effect", fmt::format("internal_leakage={}", day < 5 ? 0.0 : 1e-12 * (day - 3)), "--oil",
                  "30:38"}));
  Replay(logs);
  const nlohmann::json found = Good({"explain", "--db", Db(), "--json", "-"}).Json();
  ASSERT_FALSE(found["change_found"].is_null());
  EXPECT_EQ(found["change_found"]["by"], "model_error");
  EXPECT_NEAR(found["change_found"]["since"].get<int>(), 55, 8);
  EXPECT_THAT(found.dump(), HasSubstr("internal_leakage"));
  EXPECT_THAT(Good({"compare", "--db", Db()}).out, HasSubstr("where the model begins to err more"));
  EXPECT_THAT(
      Good({"explain", logs[4], logs[6], logs[7], "-m", machine_}).out,
      AllOf(HasSubstr("goes with the order of the logs"), Not(HasSubstr("The null of the valve wanders"))));
  const Ran learned = Run({"learn", "--db", Db(), "-m", machine_});
  EXPECT_EQ(learned.exit_code, 3);
  EXPECT_THAT(learned.err, HasSubstr("they hold a change between"));
}

/// No place of a change, and no effect of one size.
TEST_F(WorkbenchHistory, AMachineWhoseLeakGrowsFromLogToLogIsNotLearnedAsTheHealthyOne) {
  std::vector<std::string> logs;
  for (int day = 0; day < 16; ++day)
    logs.push_back(
        Simulate(fmt::format("day{}.csv", day), 50, 100 + day,
                 {"--effect", fmt::format("internal_leakage={}", 2.5e-13 * std::max(0, day - 3))}));
  Replay(logs);
  const Ran learned = Run({"learn", "--db", Db(), "-m", machine_});
  EXPECT_EQ(learned.exit_code, 3);
  EXPECT_THAT(learned.err, HasSubstr("they hold a change: "));
}

TEST_F(WorkbenchHistory, StrokesOfTwoModelsOrWithAChangeAreNotLearned) {
  Replay({Healthy(1), Healthy(2), Leaking(3), Leaking(4)});
  const Ran changed = Run({"learn", "--db", Db(), "-m", machine_});
  EXPECT_EQ(changed.exit_code, 3);
  EXPECT_THAT(changed.err, HasSubstr("they hold a change"));
  Good({"model", "add", "relief_valve", "-m", machine_});
  Replay({Healthy(5)});
  const Ran versions = Run({"learn", "--db", Db(), "-m", machine_, "--from", "run:5", "--force"});
  EXPECT_THAT(versions.err, Not(HasSubstr("versions")));
  const Ran two = Run({"learn", "--db", Db(), "-m", machine_});
  EXPECT_THAT(two.err, HasSubstr("versions 1, 2 of the model"));
}

TEST_F(WorkbenchHistory, AJournalOfADeletedDatabaseIsSetAside) {
  Replay({Healthy(1), Healthy(2)});
  const std::string journal = File("press.alarms.db");
  for (const char* end : {"", "-wal", "-shm"}) std::filesystem::remove(Db() + end);
  const Ran again = Run({"replay", File("1.csv"), "-m", machine_, "--db", Db()});
  EXPECT_EQ(again.exit_code, 0) << again.err;
  EXPECT_THAT(again.out, HasSubstr("belonged to another database"));
  EXPECT_THAT(again.out, HasSubstr("learning the healthy machine")) << "nothing is inherited";
  int dated = 0;
  for (const auto& file : std::filesystem::directory_iterator(std::filesystem::path(journal).parent_path()))
    dated += file.path().filename().string().starts_with("press.alarms.2");
  EXPECT_EQ(dated, 1);
  std::filesystem::create_directory(File("moved"));
  for (const char* name : {"press.db", "press.alarms.db"})
    std::filesystem::rename(File(name), File("moved") + "/" + name);
  const Ran moved = Good({"replay", File("2.csv"), "-m", machine_, "--db", File("moved") + "/press.db"});
  EXPECT_THAT(moved.out, Not(HasSubstr("belonged to another database"))) << "they moved together";
}

TEST_F(WorkbenchHistory, TheModelOfADatabaseIsExtendedOnItsOwnStrokes) {
  Replay({Leaking(1), Leaking(2)});
  const nlohmann::json before = Good({"compare", "--db", Db(), "--json", "-"}).Json();
  EXPECT_TRUE(before["model_error_seen"]);
  const nlohmann::json added = Good({"model", "add", "internal_leakage", "--db", Db(), "--json", "-"}).Json();
  ASSERT_EQ(added["versions"].size(), 2u);
  EXPECT_LT(added["versions"][1]["rms_holdout"].get<double>(),
            added["versions"][0]["rms_holdout"].get<double>());
  Good({"model", "promote", "--db", Db()});
  const nlohmann::json after = Good({"compare", "--db", Db(), "--json", "-"}).Json();
  EXPECT_THAT(after["effects"], ElementsAre("internal_leakage"));
  EXPECT_FALSE(after["model_error_seen"]);
  EXPECT_NEAR(after["rms_holdout"].get<double>(), added["versions"][1]["rms_holdout"].get<double>(), 1e-9);
}

TEST_F(WorkbenchHistory, ReportsLeadWithTheVerdictAndShowEveryPart) {
  const std::string log = Leaking(4), page = File("page.html");
  Good({"explain", log, "-m", machine_, "--report", page});
  const std::string text = ReadText(page);
  EXPECT_THAT(
      text, AllOf(HasSubstr("The error falls"), HasSubstr("Where the model errs"), HasSubstr("tried alone"),
                  HasSubstr("median error"), HasSubstr("largest error"), HasSubstr("Check on the machine")));
  EXPECT_LT(text.find("class=\"verdict"), text.find("The error falls"));
  EXPECT_EQ(text.find("http://", text.find("</style>")), text.find("http://www.w3.org"));
  Good({"replay", log, "-m", machine_, "--db", Db(), "--report", page});
  EXPECT_THAT(ReadText(page), AllOf(HasSubstr("Maintenance report"), HasSubstr("The error falls")));
}

TEST_F(WorkbenchHistory, WrongUseAndUnknownPlacesAreNamed) {
  EXPECT_EQ(Run({"explain", "-m", machine_}).exit_code, 2);
  EXPECT_EQ(Run({"explain", "x.csv", "-m", machine_, "--since", "3"}).exit_code, 2);
  Replay({Healthy(1)});
  for (const char* place :
       {"yesterday", "2025-02-31", "2025-03-01T06:30 or so", "2025-03-01T25:00", "nan", "inf s"}) {
    const Ran ran = Run({"explain", "--db", Db(), "--since", place});
    EXPECT_EQ(ran.exit_code, 2) << place;
    EXPECT_THAT(ran.err, HasSubstr("run:3")) << place;
  }
  const Ran run = Run({"explain", "--db", Db(), "--from", "run:9"});
  EXPECT_EQ(run.exit_code, 3);
  EXPECT_THAT(run.err, HasSubstr("no run 9"));
  const Ran machine = Run({"explain", "--db", Db(), "--machine-name", "nothing"});
  EXPECT_EQ(machine.exit_code, 3);
  EXPECT_THAT(machine.err, HasSubstr("it holds"));
}

}  // namespace
}  // namespace hydroscope
