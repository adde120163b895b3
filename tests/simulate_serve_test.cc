// `hydroscope simulate press --serve` as a process of its own, read through the sources of a machine file.
#include "acquisition/live_sources.h"
#include "tests/program_process.h"

namespace hydroscope {
namespace {

using namespace command_line_test;
using ::testing::HasSubstr;

/// The press of a machine file.
class PressProcess : public Program {
 public:
  PressProcess(const std::string& machine, const std::string& out)
      : Program({"simulate", "press", "--serve", machine}, out) {}
};

class SimulateServe : public CommandLine {
 protected:
  void SetUp() override {
    CommandLine::SetUp();
    TestPress reserve;
    std::string text = ReadText(std::string(HYDROSCOPE_SOURCE_DIR) + "/machines/press_live.toml");
    Replace(text, "domain = 0", fmt::format("domain = {}", OwnDomain()));
    Replace(text, "port = 1502", fmt::format("port = {}", reserve.port()));
    machine_ = File("press.toml");
    WriteText(machine_, text);
  }
  static void Replace(std::string& text, const std::string& from, const std::string& to) {
    const auto at = text.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    text.replace(at, from.size(), to);
  }
  std::string machine_;
};

TEST_F(SimulateServe, ObeysLinesAndStopsWhenTold) {
  PressProcess press(machine_, File("out"));
  ASSERT_TRUE(press.WaitFor("serving 4 axes at 1000 Hz"));
  press.Say("effect internal_leakage=4e-12 axis=2 ramp=10");
  EXPECT_TRUE(press.WaitFor("ok effect internal_leakage"));
  press.Say("effect internal_leakage=4e-12 axis=5");
  EXPECT_TRUE(press.WaitFor("error axis 5: the press has 4 axes"));
  press.Say("leak a little");
  EXPECT_TRUE(press.WaitFor("error 'leak a little' is not understood"));
  press.Say("quit");
  EXPECT_EQ(press.Wait(), 0);
  EXPECT_THAT(ReadText(File("out")), HasSubstr("stopped after"));
}

TEST_F(SimulateServe, StopsCleanlyOnATerminationSignal) {
  PressProcess press(machine_, File("out"));
  ASSERT_TRUE(press.WaitFor("serving"));
  EXPECT_EQ(press.Kill(SIGTERM), 0);
  EXPECT_THAT(ReadText(File("out")), HasSubstr("stopped after"));
}

/// The press of the machine file is killed and started again while sources watch it.
class SimulateServeKilled : public SimulateServe, public ::testing::WithParamInterface<const char*> {};

TEST_P(SimulateServeKilled, AndStartedAgainItIsHeardWithinTwoAndAHalfSecondsAndNothingIsLostOrDoubled) {
  std::string text = ReadText(machine_);
  Replace(text, "transport = \"default\"", fmt::format("transport = \"{}\"", GetParam()));
  WriteText(machine_, text);
  const auto machine = LoadMachine(machine_);
  ASSERT_TRUE(machine) << machine.error().text;
  auto sources = MakeSources(*machine, RealTime, 1);
  ASSERT_EQ(sources.size(), 2u);
  std::vector<TestSink> sinks(sources.size());
  for (std::size_t k = 0; k < sources.size(); ++k) ASSERT_TRUE(sources[k]->Start(sinks[k].sink()));
  for (int life = 0; life < 4; ++life) {
    PressProcess press(machine_, File("out"));
    ASSERT_TRUE(press.WaitFor("serving"));
    for (std::size_t k = 0; k < sources.size(); ++k)
      EXPECT_TRUE(sinks[k].WaitForMore(1, life == 0 ? 10 : 2.5))
          << sources[k]->status().name << ": " << sources[k]->status().state.english;
    EXPECT_TRUE(sinks[0].WaitForMore(200));
    press.Kill(SIGKILL);
  }
  for (const auto& source : sources) {
    source->Stop();
    EXPECT_EQ(source->status().lost_rows, 0) << source->status().name;
    EXPECT_EQ(source->status().duplicate_rows, 0) << source->status().name;
    EXPECT_EQ(source->status().malformed, 0) << source->status().name;
  }
}

INSTANTIATE_TEST_SUITE_P(Transports, SimulateServeKilled, ::testing::Values("default", "udp", "shm"),
                         [](const auto& info) { return std::string(info.param); });

TEST_F(SimulateServe, TellsWhatItsRingLooksLikeWhenTheMachineFileSaysOtherwise) {
  std::string text = ReadText(std::string(HYDROSCOPE_SOURCE_DIR) + "/machines/press_live_modbus.toml");
  Replace(text, "width = 58", "width = 60");
  WriteText(machine_, text);
  PressProcess press(machine_, File("out"));
  EXPECT_EQ(press.Wait(), 3);
  EXPECT_THAT(ReadText(File("out.err")), HasSubstr("records = 1024, width = 58"));
}

TEST_F(SimulateServe, AMachineFileWithoutLiveIsRefused) {
  PressProcess press(kMachine, File("out"));
  EXPECT_EQ(press.Wait(), 3);
  EXPECT_THAT(ReadText(File("out.err")), HasSubstr("[live]"));
}

}  // namespace
}  // namespace hydroscope
