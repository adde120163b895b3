#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "core/expect_ok_fixture.h"
#include "machines/die_cushion/press_file_fixture.h"
#include "monitor/press_monitor.h"
#include "studies/simulated_strokes.h"

/// A press of two axes with strokes of simulated cushions, for the tests of PressMonitor and AxisMonitor.
namespace hydroscope::press_monitor_test {

inline const std::string kMachine = PressFile(R"("left", "right")", "grid_period = 0.002\n", "K");

inline const char* const kRules = R"toml(
[monitor]
commissioning = 100
freeze = "automatic"
minimum_temperature = 22
warn_delay = 5
clear_delay = 30
deadband = 2
[watch]
K    = { change = 0.05, alarm_change = 0.25 }
V0   = { change = 0.05, alarm_change = 0.25 }
Q_vn = { change = 0.015, alarm_change = 0.08 }
y_0  = { change = { value = 0.15, unit = "%" }, alarm_change = { value = 1, unit = "%" } }
internal_leakage = { change = { value = 0.4, unit = "l/min" }, alarm_change = { value = 4, unit = "l/min" }, at = { value = 200, unit = "bar" }, only_upwards = true }
f0     = { change = 0.04, alarm_change = 0.25 }
D      = { change = 0.1, alarm_change = 0.5 }
T_dead = { change = { value = 0.3, unit = "ms" }, alarm_change = { value = 2, unit = "ms" } }
[[rule]]
id = "clogged_valve"
name = "Clogged valve"
when = { Q_vn = "down" }
may = ["y_0"]
guidance = "Look at the filter."
[[rule]]
id = "internal_leakage"
name = "Internal leakage"
when = { internal_leakage = "up" }
may = ["y_0"]
guidance = "Look at the seal."
[[rule]]
id = "slow_pilot_stage"
name = "Slow pilot stage"
when = { f0 = "down" }
guidance = "Look at the pilot filter."
[[rule]]
id = "all_valves"
name = "All valves together"
when = { Q_vn = "any" }
may = ["y_0"]
axes = 2
guidance = "Look at the oil."
)toml";

/// Those built into the program, with a commissioning as short as that of the others.
inline std::string ReadDefaultRules() {
  std::ifstream file(HYDROSCOPE_SOURCE_DIR "/machines/die_cushion_rules.toml");
  std::stringstream text;
  text << file.rdbuf();
  std::string rules = text.str();
  const std::string many = "commissioning = 1500";
  return rules.replace(rules.find(many), many.size(), "commissioning = 100");
}

/// Strokes of a simulated cushion with this fault.
inline std::vector<StrokeRecord> Simulate(double seconds, std::uint64_t seed,
                                          const std::function<void(PressOptions&)>& fault) {
  PressOptions options;
  options.seconds = seconds;
  options.seed = seed;
  options.oil_start = 303.15;
  options.oil_end = 318.15;
  fault(options);
  const auto machine = ParseMachine(kMachine, "press.toml");
  EXPECT_TRUE(machine.has_value()) << (machine ? "" : machine.error().text);
  auto log = StrokesOf(SimulatePress(options), *machine);
  EXPECT_TRUE(log.has_value());
  return log->strokes;
}

inline const std::vector<StrokeRecord>& Healthy() {
  static const auto strokes = Simulate(700, 1, [](PressOptions&) {});
  return strokes;
}
inline const std::vector<StrokeRecord>& Leaking() {
  static const auto strokes = Simulate(220, 2, [](PressOptions& o) {
    o.effects = {{"internal_leakage", 3e-12, {}}};
  });
  return strokes;
}
inline const std::vector<StrokeRecord>& Clogged() {
  static const auto strokes = Simulate(220, 3, [](PressOptions& o) { o.machine.Q_vn *= 0.95; });
  return strokes;
}

class PressMonitorTest : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(testing::TempDir()) /
              (std::string("press_monitor_") + testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
    Write("press.toml", kMachine);
    Write("press_rules.toml", kRules);
    machine_ = ParseMachine(kMachine, "press.toml").value();
    database_.emplace(Database::Open(DatabasePath()).value());
    for (int a = 0; a < 2; ++a) {
      const std::int64_t id = database_->MachineId(AxisMachineName(machine_, a)).value();
      const auto columns = BuildModel(machine_).value()->ColumnNames();
      const int version = database_->PutModelVersion(id, {1, kMachine, columns}).value();
      runs_.push_back(database_->BeginRun(id, version, "live", fmt::format("live/{}", a)).value().id);
      ids_.push_back(id);
    }
    stored_.resize(2);
  }
  void TearDown() override {
    database_.reset();
    std::filesystem::remove_all(folder_);
  }

  std::string DatabasePath() const { return (folder_ / "press.db").string(); }
  void Write(const char* name, const std::string& text) { std::ofstream(folder_ / name) << text; }

  void Store(int axis, std::vector<StrokeRecord> strokes) {
    std::int64_t& index = stored_[axis];
    for (StrokeRecord& stroke : strokes) {
      stroke.summary.begin += 1e4 * static_cast<double>(index);  // logs one after the other
      stroke.summary.end += 1e4 * static_cast<double>(index);
      stroke.summary.index = index++;
    }
    ASSERT_OK(database_->StoreStrokes(runs_[axis], strokes));
  }

  std::unique_ptr<PressMonitor> Open() {
    auto press = PressMonitor::Create((folder_ / "press.toml").string(), machine_.name,
                                      MachinesOfAxes(machine_), DatabasePath());
    EXPECT_TRUE(press.has_value()) << (press ? "" : press.error().text);
    return std::move(*press);
  }

  std::vector<JournalRow> Journal() const {
    return AlarmJournal::Open(AlarmJournal::PathFor(DatabasePath())).value().Rows("").value();
  }
  std::vector<std::string> Events() const {
    std::vector<std::string> events;
    for (const JournalRow& row : Journal())
      events.push_back(
          fmt::format("{} {} {} {}", row.machine, row.event.alarm, row.event.event, row.event.stroke));
    return events;
  }

  std::filesystem::path folder_;
  Machine machine_;
  std::optional<Database> database_;
  std::vector<std::int64_t> runs_, ids_, stored_;
};

inline std::vector<std::string> Standing(const AxisMonitor& axis) {
  std::vector<std::string> alarms;
  for (const AlarmState& alarm : axis.alarms())
    if (!AtRest(alarm)) alarms.push_back(std::string(StateName(alarm)) + " " + alarm.id);
  return alarms;
}

}  // namespace hydroscope::press_monitor_test
