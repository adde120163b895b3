// Commissioning with a signal that counts the other way round.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <random>

#include "core/expect_ok_fixture.h"
#include "monitor/learning.h"
#include "monitor/rules_for.h"
#include "pipeline/episode_pipeline.h"
#include "pipeline/run_summary.h"
#include "simulator/test_cylinder/test_cylinder.h"
#include "storage/storage_fixture.h"

namespace hydroscope {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::Field;
using testing::HasSubstr;

constexpr double kRow = 1e-3, kSecondsOfEpisode = 5;
constexpr int kSimulated = 12, kCommissioning = 100;

std::string TextOfFile(const std::string& name) {
  std::ifstream in(HYDROSCOPE_SOURCE_DIR "/machines/" + name);
  return {std::istreambuf_iterator<char>(in), {}};
}

class ReversedSignals : public testing::Test {
 protected:
  ReversedSignals()
      : machine_(ParseMachine(Text(), "cylinder.toml").value()),
        model_(BuildModel(machine_).value()),
        database_(Database::Open(folder_.File()).value()) {
    std::ofstream(folder_.File("cylinder_rules.toml")) << TextOfFile("test_cylinder_rules.toml");
    id_ = database_.MachineId(machine_.name).value();
    version_ = database_.PutModelVersion(id_, {1, Text(), model_->ColumnNames()}).value();
    rules_ = RulesFor(folder_.File("cylinder.toml"), machine_).value();
  }

  static std::string Text() {
    std::string text = TextOfFile("test_cylinder.toml");
    return text.replace(text.find("seconds = 20"), 12, "seconds = 5");
  }

  /// Episodes of a healthy cylinder whose position has this sign.
  std::vector<StrokeRecord> Simulate(double sign) const {
    const TestCylinderLog log = SimulateTestCylinder(
        {.seconds = kSimulated * kSecondsOfEpisode + 1, .sample_period = kRow, .seed = 8});
    SampleBlock rows;
    rows.time = log.t;
    rows.signal = {log.z_set, log.I_v, log.z};
    for (double& z : rows.signal[2]) z *= sign;
    rows.quality.assign(3, std::vector<Quality>(log.t.size(), 0));
    std::vector<StrokeRecord> episodes;
    auto pipeline = EpisodePipeline::Create(
        machine_, kRow, [&](StrokeRecord&& record) { episodes.push_back(std::move(record)); });
    EXPECT_TRUE(pipeline) << (pipeline ? "" : pipeline.error().text);
    (*pipeline)->Process(rows);
    (*pipeline)->Finish();
    EXPECT_GE(episodes.size(), static_cast<std::size_t>(kSimulated));
    return episodes;
  }

  /// A live run of so many of these, over and over.
  void Store(const std::vector<StrokeRecord>& episodes, int count) {
    const RunInfo run =
        database_.BeginRun(id_, version_, kLiveSource, fmt::format("live/{}", runs_++)).value();
    std::vector<StrokeRecord> strokes;
    for (int k = 0; k < count; ++k, hours_ += 1) {
      strokes.push_back(episodes[static_cast<std::size_t>(k) % episodes.size()]);
      strokes.back().summary.index = k;
      strokes.back().summary.begin = 3600 * hours_;
      strokes.back().summary.end = 3600 * hours_ + kSecondsOfEpisode;
    }
    ASSERT_OK(database_.StoreStrokes(run.id, strokes));
    ASSERT_OK(database_.FinishRun(run.id, FormatRunSummary({}), {}));
  }

  static std::vector<AlarmState> Active(const AxisMonitor& axis) {
    std::vector<AlarmState> active;
    std::ranges::copy_if(axis.alarms(), std::back_inserter(active), &AlarmState::active);
    return active;
  }

  AlarmJournal Journal() const { return AlarmJournal::Open(AlarmJournal::PathFor(folder_.File())).value(); }

  storage_test::Folder folder_;
  Machine machine_;
  std::shared_ptr<const ModelStructure> model_;
  Database database_;
  drift::RuleBook rules_;
  std::int64_t id_ = 0;
  int version_ = 0, runs_ = 0;
  double hours_ = 0;
};

TEST_F(ReversedSignals, TeachNoHealthyMachineUntilTheyAreMended) {
  const std::vector<StrokeRecord> right = Simulate(1), reversed = Simulate(-1);
  AlarmJournal journal = Journal();
  AxisMonitor axis(machine_, model_, rules_, database_, folder_.File(), id_, journal);
  Store(right, kCommissioning / 2);
  Store(reversed, kCommissioning / 2 + 30);
  ASSERT_OK(axis.CatchUp(0));
  EXPECT_EQ(axis.monitor(), nullptr);
  EXPECT_EQ(axis.Health(), 'F');
  const std::vector<AlarmState> told = Active(axis);
  ASSERT_EQ(told.size(), 1u) << "no limit of the machine file is judged by such estimates";
  EXPECT_EQ(told[0].id, "signal_loss");
  EXPECT_THAT(told[0].text, AllOf(HasSubstr("z or I_v is reversed"), HasSubstr("set scale = -1")));

  const auto candidate = LookBeforeLearning(database_, folder_.File(), machine_,
                                            {machine_.name, id_, 0, kCommissioning}, journal);
  ASSERT_TRUE(candidate) << candidate.error().text;
  EXPECT_TRUE(candidate->Refused()) << "by `learn`, too";
  EXPECT_THAT(candidate->doubts, Contains(Field(&LearningDoubt::kind, LearningDoubt::Kind::kReversed)));

  Store(right, kCommissioning - 1);
  ASSERT_OK(axis.CatchUp(0));
  EXPECT_EQ(axis.monitor(), nullptr) << "one is missing";
  EXPECT_THAT(axis.why_not_learned().english,
              AllOf(HasSubstr("z or I_v is reversed"), HasSubstr("set scale = -1")));
  EXPECT_THAT(axis.why_not_learned().german, HasSubstr("umgekehrt"));
  Store(right, 10);
  ASSERT_OK(axis.CatchUp(0));
  ASSERT_NE(axis.monitor(), nullptr);
  EXPECT_EQ(axis.monitor()->reference().first_sequence(), kCommissioning + 30);
  EXPECT_TRUE(axis.why_not_learned().empty());
  EXPECT_TRUE(Active(axis).empty());

  Store(reversed, 60);
  ASSERT_OK(axis.CatchUp(0));
  ASSERT_EQ(Active(axis).size(), 1u);
  EXPECT_EQ(Active(axis)[0].id, "signal_loss") << "a reversed signal is no change of the valve";
  Store(right, 60);
  ASSERT_OK(axis.CatchUp(0));
  EXPECT_TRUE(Active(axis).empty());

  AlarmJournal another = AlarmJournal::Open(folder_.File("another.alarms")).value();
  AxisMonitor restarted(machine_, model_, rules_, database_, folder_.File(), id_, another);
  ASSERT_OK(restarted.CatchUp(0));
  ASSERT_NE(restarted.monitor(), nullptr);
  EXPECT_EQ(restarted.monitor()->reference().first_sequence(), kCommissioning + 30)
      << "what is learned depends on the episodes alone";
}

const char* const kMass = R"toml(
[machine]
name = "mass"
[log]
sample_period = 0.01
[signals]
F = { column = "F", unit = "N" }
x = { column = "x", unit = "m" }
s = { column = "s", unit = "m/s" }
[states]
X = { ddt = "V" }
V = { ddt = "F/m" }
[outputs]
x = "X"
s = "V"
[parameters]
m = { start = 1, min = 0.1, max = 10 }
)toml";

/// What speaks against learning from a live run whose kept rows have this sign of the speed.
std::optional<LearningDoubt> DoubtOfMass(double sign) {
  const storage_test::Folder folder;
  const Machine machine = ParseMachine(kMass, "mass.toml").value();
  const auto model = BuildModel(machine).value();
  Database database = Database::Open(folder.File()).value();
  const std::int64_t id = database.MachineId("mass").value();
  const int version = database.PutModelVersion(id, {1, kMass, model->ColumnNames()}).value();
  const RunInfo run = database.BeginRun(id, version, kLiveSource, "live/0").value();
  StrokeRecord episode;
  episode.gram.integral = episode.gram.noise = episode.gram.flow = SymmetricMatrix(model->column_count());
  episode.summary.begin = 1e4, episode.summary.end = 1e4 + 10;
  EXPECT_OK(database.StoreStrokes(run.id, {episode}));
  std::mt19937 random(1);
  std::normal_distribution<double> noise;
  std::vector<double> time;
  std::vector<std::vector<double>> values(3);
  for (int k = 0; k < 1000; ++k) {
    const double t = 0.01 * k;
    time.push_back(1e4 + t);
    values[0].push_back(-std::sin(t) - std::sin(2.7 * t));
    values[1].push_back(std::sin(t) + std::sin(2.7 * t) / 7.29 + t + 1e-3 * noise(random));
    values[2].push_back(sign * (std::cos(t) + std::cos(2.7 * t) / 2.7 + 1 + 1e-2 * noise(random)));
  }
  EXPECT_OK(database.StoreRaw(run.id, {"F", "x", "s"}, time, values, 1 << 30));
  return DoubtOfSignals(database, folder.File(), {"mass", id, 0, 1}, machine);
}

TEST(ReversedRows, OfAMachineWithStatesAreSeenInTheRawWindow) {
  EXPECT_FALSE(DoubtOfMass(1).has_value());
  const auto doubt = DoubtOfMass(-1);
  ASSERT_TRUE(doubt.has_value());
  EXPECT_EQ(doubt->kind, LearningDoubt::Kind::kReversed);
  EXPECT_EQ(doubt->refused_to, 1);
  EXPECT_THAT(doubt->text.english,
              AllOf(HasSubstr("opposite sign of the derivative of x"), HasSubstr("set scale = -1")));
}

}  // namespace
}  // namespace hydroscope
