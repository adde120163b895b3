#pragma once

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "core/expect_ok_fixture.h"
#include "live/live_service.h"
#include "live/verify_live.h"
#include "machines/die_cushion/press_file_fixture.h"
#include "monitor/learning_check.h"
#include "simulator/die_cushion/press.h"

namespace hydroscope::live_service_test {

inline constexpr double kPeriod = 0.002;  // s
inline constexpr std::size_t kRowsPerBatch = 10;

inline const std::string kMachine = R"toml(
[machine]
name = "press"
model = "die_cushion"
[live]
grid_period = 0.002
axes = ["left", "right"]
[live.dds]
domain = 0
[signals]
p_A = { dds = "{axis}/p_A", unit = "Pa", min = -20e5, max = 600e5 }
z   = { dds = "{axis}/z", unit = "m" }
y_v = { dds = "{axis}/y_v", unit = "1" }
T_oil = { modbus = { register = 30 }, unit = "degC", stuck_time = 0, required = false }
[live.modbus]
poll_period = 0.5
)toml" + kPressGeometryAndGate;

inline const SimulatedLog& Log() {
  static const SimulatedLog log = [] {
    PressOptions options;
    options.seconds = 60;
    options.sample_period = kPeriod;
    return SimulatePress(options);
  }();
  return log;
}

/// Plays a simulated log for both axes, much faster than real time; stamps follow the log. The clock of the
/// service is set by what is played, and after it: a clock that is ahead tells the service that the rows are late.
class PlayedClock {
 public:
  HostTime operator()() const { return At(now_); }
  static HostTime At(std::int64_t ns) { return {ns, 1'700'000'000'000'000'000 + ns}; }
  void Set(std::int64_t ns) { now_ = ns; }

 private:
  std::atomic<std::int64_t> now_{1'000'000'000};
};

class PlayedSource : public Source {
 public:
  /// Of every `thinned` rows one is sent.
  PlayedSource(PlayedClock& clock, std::uint64_t session, std::size_t from, std::size_t to,
               std::size_t drop_every, std::size_t thinned = 1)
      : clock_(clock), session_(session), from_(from), to_(to), drop_every_(drop_every), thinned_(thinned) {}
  ~PlayedSource() override { Stop(); }

  Status Start(Sink sink) override {
    thread_ = std::thread([this, sink = std::move(sink)] { Play(sink); });
    return {};
  }
  SourceStatus status() const override {
    return {.name = "played", .connected = true, .state = {"receiving"}, .last_received = {}};
  }
  void Stop() override {
    stop_ = true;
    if (thread_.joinable()) thread_.join();
  }
  static constexpr std::size_t kNever = std::numeric_limits<std::size_t>::max();
  static inline std::atomic<bool> done{false};
  static inline std::atomic<std::size_t> hold_at{kNever};  ///< row before which it waits
  static inline const SimulatedLog* plays = nullptr;       ///< in place of Log()
  static inline std::atomic<int> hesitates{0};  ///< ms between a batch and the clock, as on a busy computer

 private:
  void Play(const Sink& sink) {
    const SimulatedLog& log = plays != nullptr ? *plays : Log();
    const std::size_t rows = kRowsPerBatch * thinned_;
    for (std::size_t row = from_; row + rows <= to_ && !stop_; row += rows) {
      const auto at = static_cast<std::int64_t>(1e9 + static_cast<double>(row + rows) * kPeriod * 1e9);
      const HostTime now = PlayedClock::At(at);
      while (row >= hold_at && !stop_) std::this_thread::sleep_for(std::chrono::milliseconds(1));
      if (drop_every_ > 0 && (row / kRowsPerBatch) % drop_every_ == drop_every_ - 1) continue;
      SampleBatch batch{.session = session_,
                        .first_sequence = row / thinned_,
                        .source_time_ns = at,
                        .period_ns = static_cast<std::int64_t>(2'000'000 * thinned_),
                        .requested = now,
                        .received = now,
                        .channels = {0, 1, 2, 4, 5, 6},
                        .rows = kRowsPerBatch,
                        .values = {}};
      for (std::size_t k = row; k < row + rows; k += thinned_)
        for (int axis = 0; axis < 2; ++axis)
          for (const double value : {log.p_A[k], log.z[k], log.y_v[k]}) batch.values.push_back(value);
      sink(std::move(batch));
      if (row % 2500 == 0) {
        for (const std::uint16_t channel : {std::uint16_t{3}, std::uint16_t{7}})
          sink({.session = 1,
                .requested = now,
                .received = now,
                .channels = {channel},
                .rows = 1,
                .values = {40.0}});
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(hesitates));
      clock_.Set(at);
      std::this_thread::sleep_for(std::chrono::microseconds(200));  // 100 times real time
    }
    done = true;
  }

  PlayedClock& clock_;
  std::uint64_t session_;
  std::size_t from_, to_, drop_every_, thinned_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

class LiveServiceTest : public testing::Test {
 protected:
  LiveServiceTest() {
    folder_ =
        std::filesystem::path(testing::TempDir()) /
        ("hydroscope_live_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
    std::ofstream(File("press.toml")) << kMachine;
    options_.machine_file = File("press.toml");
    options_.database = File("press.db");
    options_.writer.min_free = 0;
    options_.raw_period = 0.5;
  }
  ~LiveServiceTest() override { std::filesystem::remove_all(folder_); }

  std::string File(const std::string& name) const { return (folder_ / name).string(); }

  /// A service whose only source plays rows [from, to).
  Result<std::unique_ptr<LiveService>> ServiceOn(std::size_t from, std::size_t to, std::size_t drop_every) {
    return LiveService::Create(
        options_,
        [=, this](const Machine&, const Clock&) {
          std::vector<std::unique_ptr<Source>> sources;
          sources.push_back(std::make_unique<PlayedSource>(clock_, 5, from, to, drop_every, thinned_));
          return sources;
        },
        [this] { return clock_(); });
  }
  /// Plays rows [from, to) through a service of its own; `during` runs once everything was sent.
  void Serve(std::size_t from, std::size_t to, std::size_t drop_every = 0,
             const std::function<void(LiveService&)>& during = {}) {
    PlayedSource::done = false;
    auto service = ServiceOn(from, to, drop_every);
    ASSERT_TRUE(service) << service.error().text;
    EXPECT_OK((*service)->Start());
    while (!PlayedSource::done) std::this_thread::sleep_for(std::chrono::milliseconds(5));
    if (during) {
      WaitForWhatWasSent(**service);
      during(**service);
    }
    EXPECT_TRUE((*service)->Stop());
    last_ = (*service)->status();
  }
  /// Until the status tells of all that was sent. Its clock stands still by now, so that rounds of the pipeline tell: the
  /// second one that is told from now on began after now.
  static void WaitForWhatWasSent(const LiveService& service) {
    for (int round = 0; round < 2; ++round)
      for (const std::int64_t told = service.status().heartbeats; service.status().heartbeats == told;)
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  /// Begins a service over the first 25 000 rows, and waits until two strokes are stored.
  void Begin() {
    PlayedSource::done = false;
    auto service = ServiceOn(0, 25'000, 0);
    ASSERT_TRUE(service) << service.error().text;
    service_ = std::move(*service);
    ASSERT_TRUE(service_->Start());
    ASSERT_TRUE(WaitFor([](const WriterStatus& w) { return w.strokes >= 2; }));
  }
  bool WaitFor(const std::function<bool(const WriterStatus&)>& condition) {
    for (int k = 0; k < 4000; ++k) {
      if (condition(service_->status().writer)) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return false;
  }
  void ExpectReplayIsTheSame(std::int64_t runs) {
    const auto verified = VerifyLive(options_.database);
    ASSERT_TRUE(verified) << verified.error().text;
    EXPECT_EQ(static_cast<std::int64_t>(verified->size()), runs);
    for (const VerifiedRun& run : *verified) {
      EXPECT_EQ(run.outcome, VerifiedRun::Outcome::kSame) << run.axis << ": " << run.detail;
      EXPECT_GT(run.strokes, 0) << run.axis;
    }
  }

  /// What speaks against learning from all strokes of an axis.
  std::optional<LearningDoubt> DoubtOf(const std::string& axis) const {
    auto database = Database::OpenReadOnly(options_.database);
    const std::int64_t id = database->MachineId(axis).value();
    const HistoryPart all{axis, id, 0, database->EndSequence(id).value()};
    EXPECT_GT(all.strokes(), 3);
    return DoubtOfSignals(*database, options_.database, all,
                          StoredMachine(*database, options_.database, all).value());
  }

  std::filesystem::path folder_;
  LiveOptions options_;
  std::size_t thinned_ = 1;
  PlayedClock clock_;
  LiveStatus last_;
  std::unique_ptr<LiveService> service_;
};

}  // namespace hydroscope::live_service_test
