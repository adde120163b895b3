#include "pipeline/episode_pipeline.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/records/quality.h"
#include "estimation/gram_fit.h"

namespace hydroscope {
namespace {

constexpr char kLag[] = R"toml([log]
hold = "zero"
[signals]
u = { column = "u", unit = "V" }
y = { column = "y", unit = "V" }
[states]
x = { ddt = "-k*x + g*u", initial = "estimate" }
[outputs]
y = "x"
[parameters]
k = { start = 1, min = 0.1, max = 10 }
g = { start = 1, min = 0.1, max = 10 }
[episodes]
seconds = 5
)toml";

Machine LagMachine() {
  const auto machine = ParseMachine(kLag, "lag.toml");
  EXPECT_TRUE(machine) << (machine ? "" : machine.error().text);
  return machine.value_or(Machine{});
}

/// Rows 0.05 s apart, flags of a quality monitor not asked for.
SampleBlock LagRows(int rows) {
  constexpr double kPeriod = 0.05, kDecay = 2, kGain = 3;
  std::mt19937 random(8);
  std::normal_distribution<double> normal(0, 0.01);
  std::uniform_real_distribution<double> level(-1, 1);
  SampleBlock block;
  block.Resize(2, static_cast<std::size_t>(rows));
  double x = 0, u = 0;
  for (std::size_t row = 0; row < block.rows(); ++row) {
    if (row % 10 == 0) u = level(random);
    block.time[row] = kPeriod * static_cast<double>(row);
    block.signal[0][row] = u;
    block.signal[1][row] = x + normal(random);
    const double e = std::exp(-kDecay * kPeriod);
    x = x * e + kGain * u / kDecay * (1 - e);
  }
  return block;
}

SampleBlock Part(const SampleBlock& all, std::size_t first, std::size_t end) {
  SampleBlock part;
  part.Resize(all.signal.size(), end - first);
  for (std::size_t row = first; row < end; ++row) {
    part.time[row - first] = all.time[row];
    for (std::size_t s = 0; s < all.signal.size(); ++s) {
      part.signal[s][row - first] = all.signal[s][row];
      part.quality[s][row - first] = all.quality[s][row];
    }
  }
  return part;
}

std::vector<StrokeRecord> RecordsOf(const SampleBlock& all, std::size_t rows_at_a_time) {
  std::vector<StrokeRecord> records;
  auto pipeline = Pipeline::Create(LagMachine(), 0.05,
                                   [&](StrokeRecord&& record) { records.push_back(std::move(record)); });
  EXPECT_TRUE(pipeline) << (pipeline ? "" : pipeline.error().text);
  for (std::size_t row = 0; row < all.rows(); row += rows_at_a_time)
    (*pipeline)->Process(Part(all, row, std::min(all.rows(), row + rows_at_a_time)));
  (*pipeline)->Finish();
  return records;
}

TEST(EpisodePipeline, SaysTheSameHoweverRowsAreCutIntoBlocks) {
  const SampleBlock all = LagRows(620);
  const auto whole = RecordsOf(all, 620), pieces = RecordsOf(all, 37);
  ASSERT_EQ(whole.size(), 7u) << "six episodes of 5 s and the rest";
  ASSERT_EQ(pieces.size(), whole.size());
  for (std::size_t e = 0; e < whole.size(); ++e) {
    EXPECT_EQ(whole[e].gram.integral, pieces[e].gram.integral);
    EXPECT_EQ(whole[e].summary.begin, pieces[e].summary.begin);
    EXPECT_EQ(whole[e].summary.counters.used, e < 6 ? 100 : 20);
    for (std::size_t p = 0; p < 2; ++p) EXPECT_EQ(whole[e].estimates[p].value, pieces[e].estimates[p].value);
  }
}

/// An input held to a straight line by its logger drives the model all the same; an output is no reading there.
TEST(EpisodePipeline, KeepsInputsThatALoggerDrew) {
  SampleBlock all = LagRows(200);
  const auto plain = RecordsOf(all, 200);
  for (std::size_t row = 20; row < 30; ++row) all.quality[0][row] = quality::kInterpolated;
  const auto drawn = RecordsOf(all, 200);
  ASSERT_EQ(drawn.size(), plain.size());
  EXPECT_EQ(drawn[0].gram.integral, plain[0].gram.integral);
  for (std::size_t row = 20; row < 30; ++row) all.quality[1][row] = quality::kInterpolated;
  EXPECT_NE(RecordsOf(all, 200)[0].gram.integral, plain[0].gram.integral);
}

/// Sums of what episodes leave behind are a fit of all of them.
TEST(EpisodePipeline, LeavesSumsThatLaterFitsNeedNoLogFor) {
  const auto records = RecordsOf(LagRows(2000), 500);
  std::vector<StrokeGram> grams;
  for (const StrokeRecord& record : records) grams.push_back(record.gram);
  const auto model = BuildModel(LagMachine());
  ASSERT_TRUE(model) << model.error().text;
  WindowSamples window = WindowSamples::From(LagMachine().window, 0.05);
  window.level_form = true;
  const auto fit = FitBaseModel(**model, grams, window);
  ASSERT_TRUE(fit) << fit.error().text;
  EXPECT_NEAR(fit->theta[0], 2, 2.5 * fit->parameters[0].std);
  EXPECT_NEAR(fit->theta[1], 3, 2.5 * fit->parameters[1].std);
  EXPECT_LT(fit->parameters[0].std, 0.03);
  EXPECT_NEAR(fit->rms_residual, 0.01, 0.001) << "in the unit of the output";
  EXPECT_NEAR(fit->noise_floor, 0.01, 0.001);
}

TEST(EpisodePipeline, EndsAnEpisodeAtAGapAndAtABadInput) {
  SampleBlock all = LagRows(160);
  for (std::size_t row = 60; row < all.rows(); ++row) all.time[row] += 1;
  all.quality[0][60] = quality::kGap;
  all.signal[0][110] = NAN;
  const auto records = RecordsOf(all, 160);
  ASSERT_EQ(records.size(), 3u);
  EXPECT_DOUBLE_EQ(records[1].summary.begin, all.time[60]);
  EXPECT_DOUBLE_EQ(records[2].summary.begin, all.time[111]);
}

TEST(EpisodePipeline, RefusesTheStateOfAnotherModel) {
  auto pipeline = Pipeline::Create(LagMachine(), 0.05, [](StrokeRecord&&) {});
  ASSERT_TRUE(pipeline);
  const auto state = (*pipeline)->SaveState();
  EXPECT_TRUE((*pipeline)->RestoreState(state));
  auto torn = state;
  torn.resize(torn.size() - 1);
  EXPECT_FALSE((*pipeline)->RestoreState(torn));
  Machine fewer = LagMachine();
  fewer.states.parameters.pop_back();
  fewer.states.states[0].ddt = "-k*x + u";
  auto other = Pipeline::Create(fewer, 0.05, [](StrokeRecord&&) {});
  ASSERT_TRUE(other) << other.error().text;
  EXPECT_FALSE((*other)->RestoreState(state));
}

}  // namespace
}  // namespace hydroscope
