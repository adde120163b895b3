#include "live/live_service.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>

#include "core/expect_ok.h"
#include "host/real_clock.h"
#include "live/check_live.h"
#include "live/live_status.h"
#include "live/verify_live.h"
#include "machines/die_cushion/press_file_fixture.h"
#include "models/model_structure.h"
#include "monitor/learning_check.h"
#include "pipeline/log_pass.h"
#include "pipeline/raw_log.h"
#include "simulator/die_cushion/press.h"
#include "workbench/model/model_edit.h"

namespace hydroscope {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr double kPeriod = 0.002;  // s
constexpr std::size_t kRowsPerBatch = 10;

const std::string kMachine = R"toml(
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

const SimulatedLog& Log() {
  static const SimulatedLog log = [] {
    PressOptions options;
    options.seconds = 60;
    options.sample_period = kPeriod;
    return SimulatePress(options);
  }();
  return log;
}

/// Plays a simulated log for both axes, much faster than real time; stamps follow the log. The clock of the
/// service is set by what is played.
class PlayedClock {
 public:
  HostTime operator()() const { return {now_, 1'700'000'000'000'000'000 + now_}; }
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
    return {.name = "played", .connected = true, .state = "receiving", .last_received = {}};
  }
  void Stop() override {
    stop_ = true;
    if (thread_.joinable()) thread_.join();
  }
  static std::atomic<bool> done;
  static std::atomic<std::size_t> hold_at;  ///< row before which it waits

 private:
  void Play(const Sink& sink) {
    const SimulatedLog& log = Log();
    const std::size_t rows = kRowsPerBatch * thinned_;
    for (std::size_t row = from_; row + rows <= to_ && !stop_; row += rows) {
      const auto at = static_cast<std::int64_t>(1e9 + static_cast<double>(row + rows) * kPeriod * 1e9);
      while (row >= hold_at && !stop_) std::this_thread::sleep_for(std::chrono::milliseconds(1));
      clock_.Set(at);
      if (drop_every_ > 0 && (row / kRowsPerBatch) % drop_every_ == drop_every_ - 1) continue;
      SampleBatch batch{.session = session_,
                        .first_sequence = row / thinned_,
                        .source_time_ns = at,
                        .period_ns = static_cast<std::int64_t>(2'000'000 * thinned_),
                        .requested = clock_(),
                        .received = clock_(),
                        .channels = {0, 1, 2, 4, 5, 6},
                        .rows = kRowsPerBatch,
                        .values = {}};
      for (std::size_t k = row; k < row + rows; k += thinned_)
        for (int axis = 0; axis < 2; ++axis)
          for (const double value : {log.p_A[k], log.z[k], log.y_v[k]}) batch.values.push_back(value);
      sink(std::move(batch));
      if (row % 2500 == 0) {
        const HostTime now = clock_();
        for (const std::uint16_t channel : {std::uint16_t{3}, std::uint16_t{7}})
          sink({.session = 1,
                .requested = now,
                .received = now,
                .channels = {channel},
                .rows = 1,
                .values = {40.0}});
      }
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
std::atomic<bool> PlayedSource::done{false};
std::atomic<std::size_t> PlayedSource::hold_at{std::numeric_limits<std::size_t>::max()};

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
    for (int k = 0; k < 200 && (*service)->status().inbox.batches > 0; ++k)
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    if (during) during(**service);
    EXPECT_TRUE((*service)->Stop());
    last_ = (*service)->status();
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

  std::filesystem::path folder_;
  /// What speaks against learning from all strokes of an axis.
  std::optional<LearningDoubt> DoubtOf(const std::string& axis) const {
    auto database = Database::OpenReadOnly(options_.database);
    const std::int64_t id = database->MachineId(axis).value();
    const HistoryPart all{axis, id, 0, database->EndSequence(id).value()};
    EXPECT_GT(all.strokes(), 3);
    return DoubtOfSignals(*database, options_.database, all,
                          StoredMachine(*database, options_.database, all).value());
  }

  LiveOptions options_;
  std::size_t thinned_ = 1;
  PlayedClock clock_;
  LiveStatus last_;
};

TEST_F(LiveServiceTest, NothingIsLearnedFromRowsThatAreTooFarApart) {
  Serve(0, 20'000);
  EXPECT_FALSE(DoubtOf("press/left").has_value());

  std::filesystem::remove(options_.database);
  thinned_ = 50;
  std::string slow = kMachine;
  slow.replace(slow.find("grid_period = 0.002"), 19, "grid_period = 0.1");
  std::ofstream(File("press.toml")) << slow;
  clock_.Set(1'000'000'000);
  Serve(0, 20'000);
  const auto doubt = DoubtOf("press/left");
  ASSERT_TRUE(doubt.has_value());
  EXPECT_EQ(doubt->kind, LearningDoubt::Kind::kTooSlow);
  EXPECT_THAT(doubt->text.english, HasSubstr("sampled too slowly"));
}

TEST_F(LiveServiceTest, TheRawWindowReplayedGivesTheSameTrendsToTheLastBit) {
  Serve(0, 15'000);
  ExpectReplayIsTheSame(2);
  EXPECT_EQ(last_.axes[0].counters.missing_rows, 0);
  EXPECT_EQ(last_.axes[0].counters.rows, 15'000);
  EXPECT_GT(last_.axes[1].strokes, 3);
}

/// What befalls the database's file while the service runs. Times are those of the played clock.
class LostDatabaseTest : public LiveServiceTest {
 protected:
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
  /// Plays to the end. All strokes but those of the first database are in the second one, and what of it can be
  /// replayed gives the same.
  void ExpectTheRestInTheSecondDatabase() {
    ASSERT_TRUE(WaitFor([](const WriterStatus& w) {
      return w.databases == 2 && w.state == WriterState::kWriting;
    })) << service_->status().writer.problem;
    while (!PlayedSource::done) std::this_thread::sleep_for(std::chrono::milliseconds(5));
    EXPECT_TRUE(service_->Stop());
    const LiveStatus last = service_->status();
    EXPECT_EQ(last.writer.dropped_strokes + last.writer.dropped_rows + last.writer.refused, 0);
    auto database = Database::Open(options_.database);
    ASSERT_TRUE(database) << database.error().text;
    std::int64_t stored = 0, all = 0;
    for (const AxisStatus& axis : last.axes) {
      all += axis.strokes;
      stored += *database->EndSequence(*database->MachineId(axis.name));
    }
    EXPECT_GT(stored, 0);
    // Strokes under way at the end are ended by Stop.
    EXPECT_EQ(last.writer.strokes, stored + strokes_before_);
    EXPECT_GE(last.writer.strokes, all);
    const auto verified = VerifyLive(options_.database);
    ASSERT_TRUE(verified) << verified.error().text;
    std::int64_t same = 0;
    for (const VerifiedRun& run : *verified) {
      EXPECT_NE(run.outcome, VerifiedRun::Outcome::kDiffers) << run.axis << ": " << run.detail;
      same += run.outcome == VerifiedRun::Outcome::kSame;
    }
    EXPECT_GE(same, 2) << "one of each axis";
  }

  std::unique_ptr<LiveService> service_;
  std::int64_t strokes_before_ = 0;  ///< stored in the first database
};

TEST_F(LostDatabaseTest, OneThatIsDeletedIsBegunAnewWithWhatMemoryHolds) {
  options_.writer.anew_after = 2;
  Begin();
  for (const char* part : {"", "-wal", "-shm"}) std::filesystem::remove(options_.database + part);
  ASSERT_TRUE(
      WaitFor([](const WriterStatus& w) { return w.state == WriterState::kGone || w.databases == 2; }));
  // While it is gone nothing is stored; a step may have been under way when it was deleted.
  ASSERT_TRUE(WaitFor([&](const WriterStatus& w) {
    strokes_before_ = w.databases == 1 ? w.strokes : strokes_before_;
    return w.databases == 2;
  }));
  EXPECT_THAT(service_->status().writer.begun_anew, HasSubstr("deleted, moved or replaced"));
  ExpectTheRestInTheSecondDatabase();
}

TEST_F(LostDatabaseTest, OneThatIsDamagedIsSetAsideAndBegunAnew) {
  Serve(0, 8'000);  // what it stored lies in the file itself, not in the write-ahead log
  Begin();
  {
    std::fstream file(options_.database, std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(16 << 10);
    file << std::string(64 << 10, 'x');  // as a stray `dd` does
  }
  ASSERT_TRUE(WaitFor([&](const WriterStatus& w) {
    strokes_before_ = w.databases == 1 ? w.strokes : strokes_before_;
    return w.databases == 2;
  })) << service_->status().writer.problem;
  EXPECT_THAT(service_->status().writer.begun_anew, HasSubstr("is kept as"));
  int kept = 0;
  for (const auto& file : std::filesystem::directory_iterator(folder_))
    kept += file.path().filename().string().starts_with("press.20") && file.path().extension() == ".db";
  EXPECT_EQ(kept, 1);
  ExpectTheRestInTheSecondDatabase();
}

TEST_F(LostDatabaseTest, OneThatIsReplacedByACopyIsWrittenOn) {
  options_.writer.anew_after = 2;
  Serve(0, 5'000);
  std::filesystem::copy_file(options_.database, File("copy.db"));
  Begin();
  std::filesystem::rename(File("copy.db"), options_.database);
  ASSERT_TRUE(WaitFor([](const WriterStatus& w) { return w.databases == 2; }));
  EXPECT_TRUE(service_->Stop());
  EXPECT_EQ(service_->status().writer.refused, 0);
  EXPECT_TRUE(Database::Open(options_.database)->CheckIntegrity());
}

TEST_F(LiveServiceTest, ADatabaseThatIsMovedAwayIsToldAndWrittenAgainWhenItIsBack) {
  options_.writer.anew_after = 1e9;
  PlayedSource::done = false;
  auto service = ServiceOn(0, 25'000, 0);
  ASSERT_TRUE(service) << service.error().text;
  std::filesystem::rename(File("press.db"), File("elsewhere.db"));
  EXPECT_OK((*service)->Start());
  const auto wait_for = [&](WriterState state) {
    for (int k = 0; k < 1000 && (*service)->status().writer.state != state; ++k)
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    return (*service)->status().writer;
  };
  const WriterStatus gone = wait_for(WriterState::kGone);
  EXPECT_EQ(gone.state, WriterState::kGone);
  EXPECT_THAT(gone.problem, HasSubstr("deleted, moved or replaced"));
  EXPECT_EQ(gone.steps, 0);
  std::filesystem::rename(File("elsewhere.db"), File("press.db"));
  EXPECT_EQ(wait_for(WriterState::kWriting).state, WriterState::kWriting);
  EXPECT_TRUE((*service)->Stop());
  EXPECT_GT((*service)->status().writer.rows, 0);
}

TEST_F(LiveServiceTest, LostBatchesAreFlaggedInTheRawWindowAndReplayIsStillTheSame) {
  Serve(0, 15'000, 100);
  ExpectReplayIsTheSame(2);
  EXPECT_EQ(last_.axes[0].counters.missing_rows, 140);  // nobody can miss the last batch yet
  const auto machine = LoadMachine(options_.machine_file);
  auto reader = OpenRecording(options_.database + "#left", *machine);
  ASSERT_TRUE(reader) << reader.error().text;
  const auto pass = PassLog(**reader, *machine, nullptr, "raw");
  ASSERT_TRUE(pass);
  EXPECT_EQ(pass->channels[0].flagged[0], 140);
}

TEST_F(LiveServiceTest, ASecondLifeContinuesFromTheStoredStateAndTakesNoRowTwice) {
  Serve(0, 10'000);
  Serve(8'000, 20'000);  // the sender still holds two thousand rows from before
  ExpectReplayIsTheSame(4);
  EXPECT_EQ(last_.axes[0].counters.already_stored, 2'000);
  EXPECT_EQ(last_.axes[0].counters.rows, 10'000);
  const auto database = Database::OpenReadOnly(options_.database);
  const auto trend = database->Trend(1, "K");
  ASSERT_TRUE(trend);
  for (std::size_t i = 1; i < trend->size(); ++i) EXPECT_GT((*trend)[i].time, (*trend)[i - 1].time);
  // A service without memory would begin with an interval as wide as after its first stroke.
  const auto runs = database->Runs(1);
  const auto first_of_second = std::find_if(trend->begin(), trend->end(),
                                            [&](const TrendPoint& p) { return p.run == runs->back().id; });
  ASSERT_NE(first_of_second, trend->end());
  EXPECT_LT(first_of_second->estimate.std, trend->front().estimate.std);
}

TEST_F(LostDatabaseTest, AModelPromotedMeanwhileIsThatOfItsAxisFromTheNextPauseOnAndAfterARestart) {
  PlayedSource::hold_at = 15'000;
  Begin();
  auto machine = ParseMachine(kMachine, "press");
  ASSERT_TRUE(machine) << machine.error().text;
  machine->added_effects = {"external_leakage"};
  machine->model_version = 2;
  auto database = Database::Open(options_.database);
  ASSERT_TRUE(database) << database.error().text;
  const std::int64_t left = database->MachineId("press/left").value(),
                     right = database->MachineId("press/right").value();
  const auto model = BuildModel(*machine).value();
  const auto version = database->PutModelVersion(
      left, {0, EditedMachineText(kMachine, *machine), model->ColumnNames(), 0, model->ConditionNames()});
  ASSERT_TRUE(version) << version.error().text;
  EXPECT_FALSE(service_->TakePromotions().value()) << "it is only stored";
  EXPECT_OK(database->PromoteModel(left, *version));
  EXPECT_TRUE(service_->TakePromotions().value());
  EXPECT_FALSE(service_->TakePromotions().value()) << "once";
  PlayedSource::hold_at = std::numeric_limits<std::size_t>::max();
  while (!PlayedSource::done) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  EXPECT_TRUE(service_->Stop());
  service_.reset();

  const auto runs = database->Runs(left);
  ASSERT_EQ(runs->size(), 2u);
  EXPECT_EQ(runs->back().model_version, *version);
  EXPECT_GT(runs->front().strokes, 1);
  EXPECT_GT(runs->back().strokes, 1);
  EXPECT_EQ(database->Runs(right)->size(), 1u) << "its model is another's";
  ExpectReplayIsTheSame(3);
  Serve(25'000, 30'000);
  EXPECT_EQ(database->Runs(left)->back().model_version, *version);
  EXPECT_EQ(database->Runs(right)->back().model_version, 1);
}

TEST_F(LiveServiceTest, NewLimitsAreTakenOverWithoutLosingTheState) {
  Serve(0, 10'000, 0, [this](LiveService& service) {
    std::string text = kMachine;
    text.replace(text.find("max = 600e5"), 11, "max = 500e5");
    std::ofstream(File("press.toml")) << text;
    EXPECT_OK(service.Reload());
    text.replace(text.find("0.0125"), 6, "0.0130");
    std::ofstream(File("press.toml")) << text;
    const Status refused = service.Reload();
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().text, HasSubstr("restart the service"));
    EXPECT_THAT(service.status().limits, HasSubstr("more than limits"));
  });
}

TEST_F(LiveServiceTest, StatusAndMetricsTellChannelsAxesAndCounters) {
  Serve(0, 10'000, 0, [](LiveService& service) {
    const LiveStatus status = service.status();
    const auto json = StatusJson(status);
    EXPECT_EQ(json.at("axes").size(), 2u);
    EXPECT_EQ(json.at("channels").size(), 8u);
    EXPECT_EQ(json.at("axes")[0].at("counters").at("rows"), 10'000);
    EXPECT_THAT(StatusText(json), HasSubstr("press/left"));
    nlohmann::json pure = json;
    pure["channels"][0].update({{"unit", "1"}, {"value", 0.4672}, {"noise_std", 0.00018}});
    EXPECT_THAT(StatusText(pure),
                AllOf(HasSubstr(" 0.4672 "), Not(HasSubstr("0.4672 1")), Not(HasSubstr("0.00018 1"))));
    auto ahead = json;  // a sender whose clock is ahead
    for (auto& channel : ahead.at("channels")) channel["age_s"] = -3.2;
    EXPECT_THAT(StatusText(ahead), HasSubstr(" 0 s "));
    EXPECT_THAT(StatusText(ahead), Not(HasSubstr("-3")));
    EXPECT_THAT(PrometheusText(status),
                HasSubstr("hydroscope_axis_events_total{axis=\"press/left\",event=\"rows\"} 10000"));
  });
}

TEST_F(LiveServiceTest, AMachineFileWithoutLiveSectionSaysWhatIsMissing) {
  std::string text = kMachine;
  const std::size_t live = text.find("[live]"), signals = text.find("[signals]");
  std::ofstream(File("press.toml")) << text.substr(0, live) << R"toml(
[signals]
p_A = { column = "p_A", unit = "Pa" }
z = { column = "z", unit = "m" }
y_v = { column = "y_v", unit = "1" }
[geometry]
A_A = 0.0125
dp_nom = 35e5
p_t = 0
)toml";
  static_cast<void>(signals);
  const auto service = LiveService::Create(options_, {}, RealTime);
  ASSERT_FALSE(service);
  EXPECT_THAT(service.error().text, HasSubstr("no [live] section"));
}

TEST(RawName, TellsDatabaseAxisRunAndTimes) {
  EXPECT_FALSE(ParseRawName("press.csv").has_value());
  const auto all = ParseRawName("press.db#cushion_1");
  ASSERT_TRUE(all);
  EXPECT_EQ(all->axis, "cushion_1");
  EXPECT_EQ(all->run, 0);
  const auto piece = ParseRawName("a/press.db#press/cushion_1/12@5:60");
  ASSERT_TRUE(piece);
  EXPECT_EQ(piece->database, "a/press.db");
  EXPECT_EQ(piece->axis, "press/cushion_1");
  EXPECT_EQ(piece->run, 12);
  EXPECT_EQ(piece->from, 5);
  EXPECT_EQ(piece->to, 60);
  EXPECT_FALSE(piece->by_time);
  EXPECT_EQ(ParseRawName("press.db#/3@:10")->to, 10);
  const auto by_time = ParseRawName("press.db#press/left/3@=1700000005.5:1700000060");
  ASSERT_TRUE(by_time);
  EXPECT_TRUE(by_time->by_time);
  EXPECT_EQ(by_time->from, 1700000005.5);
  EXPECT_EQ(by_time->axis, "press/left");
}

}  // namespace
}  // namespace hydroscope
