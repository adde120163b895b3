#include "live/live_service.h"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "host/real_clock.h"
#include "live/check_live.h"
#include "live/live_service_fixture.h"
#include "live/live_status.h"
#include "models/model_structure.h"
#include "pipeline/log_pass.h"
#include "pipeline/raw_log.h"
#include "workbench/explain/explain_history.h"
#include "workbench/history/kept_noise.h"
#include "workbench/model/model_edit.h"

namespace hydroscope {
namespace {

using namespace live_service_test;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

TEST_F(LiveServiceTest, NothingIsLearnedFromRowsThatAreTooFarApart) {
  Serve(0, 20'000);
  EXPECT_FALSE(DoubtOf("press/left").has_value());

  std::filesystem::remove(options_.database);
  thinned_ = 50;
  std::string slow = kMachine;
  slow.replace(slow.find("grid_period = 0.002"), 19, "grid_period = 0.1");
  std::ofstream(File("press.toml")) << slow;
  clock_.Set(1'000'000'000);
  PlayedSource::hesitates = 8;  // more than a round of the pipeline
  Serve(0, 20'000);
  PlayedSource::hesitates = 0;
  EXPECT_EQ(last_.axes[0].counters.missing_rows, 0);
  EXPECT_EQ(last_.axes[0].counters.rows, 400);
  const auto doubt = DoubtOf("press/left");
  ASSERT_TRUE(doubt.has_value());
  EXPECT_EQ(doubt->kind, LearningDoubt::Kind::kTooSlow);
  EXPECT_THAT(doubt->text.english, HasSubstr("sampled too slowly"));
}

/// Sums of products show the noise of single rows alone; the rows that are kept show its colour.
TEST_F(LiveServiceTest, StoredStrokesAreExplainedWithTheNoiseOfTheRowsThatAreKept) {
  PressOptions options;
  options.seconds = 60;
  options.sample_period = kPeriod;
  options.effects = {{"external_leakage", 6e-12, {}}};  // the machine file has no p_B
  options.imperfections = {{"coloured_noise", 1, {{"phi", 0.8}, {"white", 1}}, "all"}};
  const SimulatedLog log = SimulatePress(options);
  PlayedSource::plays = &log;
  Serve(0, 29'000);
  PlayedSource::plays = nullptr;
  auto database = Database::OpenReadOnly(options_.database);
  ASSERT_TRUE(database);
  const auto parts = ChosenMachines(*database, options_.database, {"press/left"});
  ASSERT_TRUE(parts) << parts.error().text;
  const auto machine = StoredMachine(*database, options_.database, parts->front());
  ASSERT_TRUE(machine) << machine.error().text;
  const auto history = LoadHistory(*database, options_.database, *parts, *machine);
  ASSERT_TRUE(history) << history.error().text;
  EXPECT_GT(history->noise_scale, 1.5);
  const std::int64_t worked_out = NoiseOfKeptRowsWorkedOut();
  EXPECT_EQ(LoadHistory(*database, options_.database, *parts, *machine)->noise_scale, history->noise_scale);
  EXPECT_EQ(NoiseOfKeptRowsWorkedOut(), worked_out) << "while the strokes are the same";
  const auto result = ExplainHistory(*history);
  ASSERT_TRUE(result) << result.error().text;
  EXPECT_THAT(result->explanation.set, Contains("external_leakage"));
}

TEST_F(LiveServiceTest, TheRawWindowReplayedGivesTheSameTrendsToTheLastBit) {
  Serve(0, 15'000);
  ExpectReplayIsTheSame(2);
  EXPECT_EQ(last_.axes[0].counters.missing_rows, 0);
  EXPECT_EQ(last_.axes[0].counters.rows, 15'000);
  EXPECT_GT(last_.axes[1].strokes, 3);
  EXPECT_EQ(last_.axes[0].strokes + last_.axes[1].strokes, last_.writer.strokes)
      << "those that the end ended too";
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

TEST_F(LiveServiceTest, HowFarARawWindowIsReadIsKnownFromItsBeginOn) {
  Serve(0, 15'000);
  const auto machine = LoadMachine(options_.machine_file);
  auto piece = OpenRecording(options_.database + "#left@3:13", *machine);
  ASSERT_TRUE(piece) << piece.error().text;
  auto whole = OpenRecording(options_.database + "#left", *machine);
  ASSERT_TRUE(whole) << whole.error().text;
  SampleBlock block;
  ASSERT_EQ((*piece)->Read(block, 1000).value_or(0), 1000u);
  EXPECT_NEAR((*piece)->Progress(), 1000 * (*piece)->SamplePeriod() / 10, 0.01);
  ASSERT_EQ((*whole)->Read(block, 1000).value_or(0), 1000u);
  EXPECT_LT((*whole)->Progress(), 0.1);
  while ((*piece)->Read(block, 1000).value_or(0) > 0) continue;
  EXPECT_GT((*piece)->Progress(), 0.99);
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

TEST_F(LiveServiceTest, AModelPromotedMeanwhileIsThatOfItsAxisFromTheNextPauseOnAndAfterARestart) {
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
  PlayedSource::hold_at = PlayedSource::kNever;
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

TEST_F(LiveServiceTest, AFileThatIsReadAgainUnchangedEndsNoRun) {
  PlayedSource::hold_at = 15'000;
  Begin();
  EXPECT_OK(service_->Reload());
  PlayedSource::hold_at = PlayedSource::kNever;
  while (!PlayedSource::done) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  EXPECT_TRUE(service_->Stop());
  auto database = Database::OpenReadOnly(options_.database);
  EXPECT_EQ(database->Runs(database->MachineId("press/left").value())->size(), 1u);
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
    EXPECT_THAT(service.status().limits.english, HasSubstr("more than limits"));
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
    nlohmann::json fitted = json;
    fitted["axes"][0]["estimates"] = {{"y_0", {{"value", 0.0086229}, {"std", 0.00025}, {"unit", "1"}}},
                                      {"K", {{"value", 1.2e9}, {"std", nullptr}, {"unit", "Pa"}}}};
    EXPECT_THAT(StatusText(fitted), HasSubstr("K 12000 bar, y_0 0.862 ± 0.049 % of stroke"));
    nlohmann::json pure = json;
    pure["channels"][0].update({{"unit", "1"}, {"value", 0.4672}, {"noise_std", 0.00018}});
    EXPECT_THAT(StatusText(pure),
                AllOf(HasSubstr(" 0.4672 "), Not(HasSubstr("0.4672 1")), Not(HasSubstr("0.00018 1"))));
    auto ahead = json;  // a sender whose clock is ahead
    for (auto& channel : ahead.at("channels")) channel["age_s"] = -3.2;
    EXPECT_THAT(StatusText(ahead), HasSubstr(" 0 s "));
    EXPECT_THAT(StatusText(ahead), Not(HasSubstr("-3 s")));
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
  EXPECT_FALSE(ParseRawName("press.db#left@nan:5")->from);
}

}  // namespace
}  // namespace hydroscope
