#include "core/unwrapped_fixture.h"
#include "tests/command_line_fixture.h"

namespace hydroscope {
namespace {

using namespace command_line_test;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

TEST_F(CommandLine, FromALogToItsTrends) {
  const std::string log = Simulate("press.csv", 60, 3), db = File("press.db"), report = File("press.html");

  const Ran check = Run({"check", log, "-m", kMachine, "--json", "-"});
  EXPECT_EQ(check.exit_code, 0) << check.err;
  const int strokes = check.Json()["strokes"];
  EXPECT_GT(strokes, 5);
  EXPECT_EQ(check.Json()["parameters"]["Q_vn"]["verdict"], "good");

  const Ran fit = Run({"fit", log, "-m", kMachine, "--json", "-"});
  EXPECT_EQ(fit.exit_code, 0) << fit.err;
  EXPECT_EQ(fit.Json()["strokes"], strokes);
  EXPECT_NEAR(fit.Json()["parameters"]["K"]["value"].get<double>(), 1.21e9, 0.1e9);

  const Ran replay = Run({"replay", log, "-m", kMachine, "--db", db, "--report", report, "--json", "-"});
  EXPECT_EQ(replay.exit_code, 0) << replay.err;
  EXPECT_EQ(replay.Json()["strokes"], strokes);
  EXPECT_EQ(replay.Json()["logs"][0]["status"], "replayed");
  EXPECT_NEAR(replay.Json()["parameters"]["Q_vn"]["value"].get<double>(), 1.7e-3, 0.05e-3);
  EXPECT_THAT(ReadText(report),
              AllOf(HasSubstr("</html>"), HasSubstr("Q_vn"), HasSubstr("measured and modelled")));

  const Ran trends = Run({"trends", "--db", db, "--parameter", "Q_vn", "--json", "-"});
  EXPECT_EQ(trends.exit_code, 0) << trends.err;
  EXPECT_TRUE(trends.Json().is_object() || trends.Json().is_array()) << trends.out.substr(0, 300);
}

TEST_F(CommandLine, WrongUseIsTwoAndHelpIsZero) {
  EXPECT_EQ(Run({}).exit_code, 2);
  EXPECT_EQ(Run({"replay"}).exit_code, 2);
  EXPECT_EQ(Run({"check", "x.csv"}).exit_code, 2);
  EXPECT_EQ(Run({"replya"}).exit_code, 2);
  for (const char* command : {"init", "check", "simulate", "fit", "frf", "replay", "trends", "benchmark"}) {
    const Ran help = Run({command, "--help"});
    EXPECT_EQ(help.exit_code, 0) << command;
    EXPECT_THAT(help.out, HasSubstr("hydroscope " + std::string(command))) << "no example";
  }
}

TEST_F(CommandLine, AWrongValueIsToldWithWhatIsExpected) {
  struct Case {
    std::vector<std::string> words;
    const char* told;
  };
  for (
      const Case& c : {
          Case{{"frf", "x.csv", "-m", "m.toml", "--settle", "-1"},
               "--settle -1: expected a number from 0 to 100000"},
          Case{{"simulate", "flexible-axis", "--out", "x.csv", "--rows", "999999999999"},
               "--rows 999999999999: expected a smaller number"},
          Case{{"trends", "--db", "x.db", "--last", "abc"}, "--last abc: expected a whole number above 0"},
          Case{{"serve", "m.toml", "--db", "x.db", "--port", "99999"},
               "--port 99999: expected a whole number from 0 to 65535"},
          Case{{"completion", "fish"}, "SHELL fish: expected bash or zsh"},
          Case{{"simulate", "press", "--seconds", "abc", "--out", "x.csv"},
               "--seconds abc: expected a number"},
          Case{{"simulate", "press", "--seconds", "", "--out", "x.csv"}, "--seconds '': expected a number"},
          Case{{"simulate", "press", "--random-machine", "-3", "--out", "x.csv"},
               "--random-machine -3: expected a larger number"},
          Case{{"fit"}, "LOG is missing: Logs of one machine"},
          Case{
              {"fit", "x.csv"},
              "--machine is missing: Machine file (TOML); `hydroscope init LOG --out press.toml` proposes one"},
          Case{{"learn", "--db"}, "--db: its value is missing"},
      }) {
    const Ran ran = Run(c.words);
    EXPECT_EQ(ran.exit_code, 2) << c.told;
    EXPECT_THAT(ran.err, testing::StartsWith(std::string("hydroscope: ") + c.told));
    EXPECT_THAT(ran.err, HasSubstr("--help` shows how"));
  }
  EXPECT_THAT(Run({"alarms", "--db", "x.db", "ack"}).err, HasSubstr("`hydroscope alarms ack --help`"));
}

TEST_F(CommandLine, OutputThatCannotBeWrittenIsAnErrorWithItsCause) {
  const auto into_full_disk = [&](const std::string& command) {
    return WEXITSTATUS(
        std::system((HYDROSCOPE_BINARY " " + command + " >/dev/full 2>" + File("told")).c_str()));
  };
  for (const char* command :
       {"manual", "completion bash", "--version", "model effects", "model effects --json -"}) {
    EXPECT_EQ(into_full_disk(command), 1) << command;
    EXPECT_THAT(ReadText(File("told")), HasSubstr("the disk is full")) << command;
  }
  const Ran folder = Run({"model", "effects", "--json", File("none") + "/x.json"});
  EXPECT_EQ(folder.exit_code, 3);
  EXPECT_THAT(folder.err, HasSubstr("there is no such folder"));
}

TEST_F(CommandLine, AnUnknownWordNamesTheNearestOne) {
  const Ran command = Run({"replya", "x.csv"});
  EXPECT_EQ(command.exit_code, 2);
  EXPECT_THAT(command.err, HasSubstr("unknown command 'replya'; did you mean 'replay'?"));
  const Ran option = Run({"fit", "x.csv", "--machin", "m.toml"});
  EXPECT_EQ(option.exit_code, 2);
  EXPECT_THAT(option.err, HasSubstr("unknown option '--machin'; did you mean '--machine'?"));
  const Ran version = Run({"--version"});
  EXPECT_EQ(version.exit_code, 0);
  EXPECT_THAT(version.out, testing::MatchesRegex("hydroscope [0-9]+\\.[0-9]+\\.[0-9]+\n"));
}

TEST_F(CommandLine, AKeyOfFiftyThousandPartsIsRefused) {
  std::string key = "a";
  for (int k = 0; k < 50'000; ++k) key += ".a";
  for (const std::string& text : {key + " = 1\n", "[" + key + "]\nb = 1\n"}) {
    WriteText(File("deep.toml"), "[machine]\nname = \"deep\"\n" + text);
    const Ran ran = Run({"check", File("none.csv"), "-m", File("deep.toml")});
    EXPECT_EQ(ran.exit_code, 3);
    EXPECT_THAT(ran.err, HasSubstr("deep.toml:3: a key of more than 32 parts"));
  }
}

TEST_F(CommandLine, AnOutputThatExplainsItselfIsRefused) {
  const std::string log = "t,x,U\n0,1,1\n0.01,1,2\n";
  WriteText(File("own.csv"), log);
  const auto machine = [&](const std::string& terms) {
    WriteText(File("own.toml"),
              "[machine]\nname = \"own\"\n[log]\ntime = { column = \"t\", unit = \"s\" }\n[signals]\n"
              "x = { column = \"x\", unit = \"m\" }\nU = { column = \"U\", unit = \"V\" }\n"
              "[balance]\noutput = \"U\"\nunit = \"V\"\nterms = { " +
                  terms + " }\n");
    return Run({"fit", File("own.csv"), "-m", File("own.toml")}).err;
  };
  EXPECT_THAT(machine("a = \"x\", b = \"2*U\""),
              HasSubstr("b: U is the output itself, and would explain all of it\n    2*U\n      ^"));
  EXPECT_THAT(machine("a = \"x\", b = \"ddt(U)\""), Not(HasSubstr("the output itself")));
  EXPECT_THAT(machine("a = \"x\" }\n[[effect]]\nid = \"itself\"\nterms = { k = \"U\""),
              HasSubstr("k: U is the output itself"));
}

TEST_F(CommandLine, AFileSizeLimitIsAnErrorAndNoCrash) {
  const std::string log = Simulate("press.csv", 20, 3);
  const std::string command = "ulimit -f 100; exec " HYDROSCOPE_BINARY " replay " + log + " -m " + kMachine +
                              " --db " + File("limited.db") + " > /dev/null 2> " + File("limited.err");
  const int state = std::system(command.c_str());
  ASSERT_TRUE(WIFEXITED(state)) << "ended by a signal";
  EXPECT_NE(WEXITSTATUS(state), 0);
  EXPECT_LT(WEXITSTATUS(state), 5);
  EXPECT_THAT(Unwrapped(ReadText(File("limited.err"))),
              AllOf(HasSubstr("limited.db cannot be written"), HasSubstr("ulimit -f")));
}

TEST_F(CommandLine, EveryCommandAndOptionIsDocumented) {
  const std::string text = ReadText(std::string(HYDROSCOPE_SOURCE_DIR) + "/docs/command_line.md");
  const std::vector<std::vector<std::string>> commands = {{"init"},
                                                          {"check"},
                                                          {"simulate", "press"},
                                                          {"simulate", "valve"},
                                                          {"simulate", "manipulator"},
                                                          {"design"},
                                                          {"fit"},
                                                          {"frf"},
                                                          {"replay"},
                                                          {"trends"},
                                                          {"serve"},
                                                          {"status"},
                                                          {"verify-live"},
                                                          {"benchmark", "coverage"},
                                                          {"benchmark", "frf"},
                                                          {"benchmark", "since"},
                                                          {"benchmark", "filter-study"},
                                                          {"benchmark", "thirty-runs"},
                                                          {"benchmark", "endurance"},
                                                          {"benchmark", "example-log"}};
  for (std::vector<std::string> command : commands) {
    EXPECT_THAT(text, HasSubstr("## " + command.front() + "\n"));
    command.push_back("--help");
    std::istringstream words(Run(command).out);
    int options = 0;
    for (std::string word; words >> word;) {
      if (word.rfind("--", 0) != 0) continue;
      const std::string option = word.substr(0, word.find_first_of(",=:;.)`'\" ", 2));
      EXPECT_NE(text.find("`" + option), std::string::npos) << command.front() << " " << option;
      ++options;
    }
    EXPECT_GT(options, 1) << command.front();
  }
}

TEST_F(CommandLine, FilesThatAreNotThereAreThreeAndNamed) {
  const std::string log = Simulate("press.csv", 5, 1);
  for (const std::string command : {"check", "fit"}) {
    const Ran no_machine = Run({command, log, "-m", "/nonexistent.toml"});
    EXPECT_EQ(no_machine.exit_code, 3) << command;
    EXPECT_THAT(no_machine.err, HasSubstr("/nonexistent.toml"));
    const Ran no_log = Run({command, "/nonexistent.csv", "-m", kMachine});
    EXPECT_EQ(no_log.exit_code, 3) << command;
    EXPECT_THAT(no_log.err, HasSubstr("/nonexistent.csv"));
  }
  EXPECT_EQ(Run({"replay", log, "-m", "/nonexistent.toml", "--db", File("a.db")}).exit_code, 3);
  EXPECT_EQ(Run({"replay", log, "-m", kMachine, "--db", "/nonexistent/a.db"}).exit_code, 3);
  EXPECT_EQ(Run({"replay", "/nonexistent.csv", "-m", kMachine, "--db", File("a.db")}).exit_code, 3);
  EXPECT_EQ(Run({"trends", "--db", "/nonexistent.db"}).exit_code, 3);
}

TEST_F(CommandLine, AMissingColumnNamesItAndListsTheOnesFound) {
  WriteText(File("bad.csv"), "t,p_A,z\n0.000,1e6,0.2\n0.002,1e6,0.2\n0.004,1e6,0.2\n");
  const Ran ran = Run({"check", File("bad.csv"), "-m", kMachine});
  EXPECT_EQ(ran.exit_code, 3);
  EXPECT_THAT(ran.err, AllOf(HasSubstr("y_v"), HasSubstr("p_A")));
}

TEST_F(CommandLine, AnEmptyFileIsThree) {
  WriteText(File("empty.csv"), "");
  for (const std::string command : {"check", "fit"}) {
    const Ran ran = Run({command, File("empty.csv"), "-m", kMachine});
    EXPECT_EQ(ran.exit_code, 3) << command;
    EXPECT_THAT(ran.err, HasSubstr("empty.csv"));
  }
}

TEST_F(CommandLine, AColumnOfNaNsLeavesNoStrokeAndSaysWhy) {
  std::istringstream good(ReadText(Simulate("press.csv", 10, 1)));
  std::string bad, line;
  for (int row = 0; std::getline(good, line); ++row) {
    const auto first = line.find(','), second = line.find(',', first + 1);
    if (row > 0) line.replace(first + 1, second - first - 1, "nan");
    bad += line + "\n";
  }
  WriteText(File("nan.csv"), bad);
  const Ran check = Run({"check", File("nan.csv"), "-m", kMachine});
  EXPECT_EQ(check.exit_code, 4);
  EXPECT_THAT(check.out, AllOf(HasSubstr("5000 x missing"), HasSubstr("0 strokes"),
                               HasSubstr("0 of 5000 readings are good")));
  const Ran replay = Run({"replay", File("nan.csv"), "-m", kMachine, "--db", File("a.db")});
  EXPECT_EQ(replay.exit_code, 4);
  EXPECT_THAT(replay.out, AllOf(HasSubstr("NO STROKE"), HasSubstr("values flagged missing, p_A")));
}

TEST_F(CommandLine, ATornFileIsReadUpToTheTearAndCountsAsPartlyDone) {
  std::string text = ReadText(Simulate("press.csv", 30, 1));
  text.resize(text.size() * 2 / 3);
  text.resize(text.rfind('\n') + 12);  // half a row
  WriteText(File("torn.csv"), text);
  const Ran check = Run({"check", File("torn.csv"), "-m", kMachine, "--json", "-"});
  EXPECT_EQ(check.exit_code, 4) << check.err;
  EXPECT_EQ(check.Json()["rejected_rows"], 1);
  const Ran replay = Run({"replay", File("torn.csv"), "-m", kMachine, "--db", File("a.db")});
  EXPECT_EQ(replay.exit_code, 4);
  EXPECT_THAT(replay.out, HasSubstr("1 row could not be read"));
}

TEST_F(CommandLine, ABadLogInTheMiddleDoesNotStopTheOthers) {
  const std::string first = Simulate("1.csv", 20, 1), last = Simulate("3.csv", 20, 3);
  WriteText(File("2.csv"), "t,p_A\n0,1\n");
  const Ran ran =
      Run({"replay", first, File("2.csv"), last, "-m", kMachine, "--db", File("a.db"), "--json", "-"});
  EXPECT_EQ(ran.exit_code, 4);
  EXPECT_THAT(ran.err, HasSubstr("2.csv"));
  EXPECT_EQ(ran.Json()["logs"][0]["status"], "replayed");
  EXPECT_EQ(ran.Json()["logs"][1]["status"], "failed");
  EXPECT_EQ(ran.Json()["logs"][2]["status"], "replayed");
  EXPECT_EQ(ran.Json()["runs"], 2);
  EXPECT_THAT(ran.Json()["skipped"][0]["what"].get<std::string>(), HasSubstr("2.csv"));
}

TEST_F(CommandLine, CheckTellsBarFromPascal) {
  std::string machine = ReadText(kMachine);
  const auto at = machine.find("unit = \"Pa\"");
  ASSERT_NE(at, std::string::npos);
  machine.replace(at, 11, "unit = \"bar\"");
  WriteText(File("m.toml"), machine);
  const Ran ran = Run({"check", Simulate("press.csv", 5, 1), "-m", File("m.toml")});
  EXPECT_THAT(ran.out, HasSubstr("They look like Pa"));
}

}  // namespace
}  // namespace hydroscope
