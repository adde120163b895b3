#include "pipeline/pipeline.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "simulator/die_cushion/press.h"
#include "simulator/random.h"
#include "studies/simulated_strokes.h"
#include "tests/counting_new.h"

namespace hydroscope {
namespace {

PressOptions Press(std::uint64_t seed, double seconds = 40) {
  PressOptions options;
  options.seed = seed;
  options.seconds = seconds;
  return options;
}

SampleBlock Rows(const PressOptions& press) { return RowsOf(SimulatePress(press), MachineFor(press)); }

/// The same strokes again and again: one speed, one pressure, nothing that tells the parameters apart.
PressOptions Monotonous(std::uint64_t seed) {
  PressOptions options = Press(seed, 60);
  options.motion.speed_min = options.motion.speed_max = 0.05;
  options.motion.set_point_min = options.motion.set_point_max = options.motion.rest_pressure = 60e5;
  options.motion.wander = options.motion.dither = 0;
  return options;
}

struct Line {
  std::vector<StrokeRecord> strokes;
  std::unique_ptr<Pipeline> pipeline;

  explicit Line(const Machine& machine) {
    pipeline =
        *Pipeline::Create(machine, 0.002, [this](StrokeRecord&& r) { strokes.push_back(std::move(r)); });
  }
  void Feed(const SampleBlock& all, std::size_t rows_per_block = 1024) {
    SampleBlock part;
    for (std::size_t at = 0; at < all.rows(); at += rows_per_block) {
      const std::size_t count = std::min(rows_per_block, all.rows() - at);
      part.Resize(all.signal.size(), count);
      for (std::size_t k = 0; k < count; ++k) {
        part.time[k] = all.time[at + k];
        for (std::size_t s = 0; s < all.signal.size(); ++s) {
          part.signal[s][k] = all.signal[s][at + k];
          part.quality[s][k] = all.quality[s][at + k];
        }
      }
      pipeline->Process(part);
    }
  }
  void Run(const SampleBlock& all, std::size_t rows_per_block = 1024) {
    Feed(all, rows_per_block);
    pipeline->Finish();
  }
};

std::uint64_t Bits(double x) { return std::bit_cast<std::uint64_t>(x); }

void ExpectSame(const StrokeRecord& a, const StrokeRecord& b) {
  EXPECT_EQ(Bits(a.summary.begin), Bits(b.summary.begin));
  EXPECT_EQ(Bits(a.summary.end), Bits(b.summary.end));
  EXPECT_EQ(Bits(a.summary.rms_error), Bits(b.summary.rms_error));
  EXPECT_EQ(Bits(a.summary.noise_floor), Bits(b.summary.noise_floor));
  EXPECT_EQ(a.gram.integral, b.gram.integral);
  EXPECT_EQ(a.gram.noise, b.gram.noise);
  EXPECT_EQ(a.gram.flow, b.gram.flow);
  ASSERT_EQ(a.estimates.size(), b.estimates.size());
  for (std::size_t i = 0; i < a.estimates.size(); ++i) {
    EXPECT_EQ(Bits(a.estimates[i].value), Bits(b.estimates[i].value)) << a.estimates[i].parameter;
    EXPECT_EQ(Bits(a.estimates[i].std), Bits(b.estimates[i].std)) << a.estimates[i].parameter;
    EXPECT_EQ(Bits(a.estimates[i].excitation), Bits(b.estimates[i].excitation));
    EXPECT_EQ(Bits(a.estimates[i].last_excited), Bits(b.estimates[i].last_excited));
    EXPECT_EQ(a.estimates[i].reason, b.estimates[i].reason);
  }
}

void ExpectSame(const std::vector<StrokeRecord>& a, const std::vector<StrokeRecord>& b) {
  ASSERT_EQ(a.size(), b.size());
  ASSERT_GE(a.size(), 3u);
  for (std::size_t k = 0; k < a.size(); ++k) ExpectSame(a[k], b[k]);
}

std::vector<Machine> EveryForm(const PressOptions& press) {
  std::vector<Machine> machines(3, MachineFor(press));
  machines[1].estimator.form = EstimatorForm::kExponential;
  machines[2].estimator.form = EstimatorForm::kExponential;
  machines[2].estimator.equation = EquationForm::kPublished;
  return machines;
}

TEST(Pipeline, DoesNotDependOnHowRowsAreCutIntoBlocks) {
  const PressOptions press = Press(1);
  const SampleBlock rows = Rows(press);
  for (const Machine& machine : EveryForm(press)) {
    Line whole(machine);
    whole.Run(rows, rows.rows());
    for (std::size_t size : {1, 7, 1024}) {
      Line cut(machine);
      cut.Run(rows, size);
      ExpectSame(cut.strokes, whole.strokes);
      EXPECT_EQ(cut.pipeline->SaveState(), whole.pipeline->SaveState()) << size;
    }
  }
}

TEST(Pipeline, StateCarriedBetweenLogsEqualsOnePipelineOverBoth) {
  const PressOptions press = Press(1);
  for (const Machine& machine : EveryForm(press)) {
    Line both(machine), first(machine), second(machine);
    both.Run(Rows(press));
    first.Run(Rows(press));
    ASSERT_TRUE(second.pipeline->RestoreState(first.pipeline->SaveState()));
    both.strokes.clear();
    both.Run(Rows(Press(2)));
    second.Run(Rows(Press(2)));
    ExpectSame(second.strokes, both.strokes);
    EXPECT_EQ(second.pipeline->SaveState(), both.pipeline->SaveState());
  }
}

TEST(Pipeline, StateSavedBeforeTheFirstEstimateIsCarriedToo) {
  const PressOptions press = Press(1);
  const Machine machine = MachineFor(press);
  Line both(machine), first(machine), second(machine);
  const SampleBlock begin = Rows(Press(3, 0.9));
  both.Run(begin);
  first.Run(begin);
  ASSERT_TRUE(second.pipeline->RestoreState(first.pipeline->SaveState()));
  both.strokes.clear();
  both.Run(Rows(press));
  second.Run(Rows(press));
  ExpectSame(second.strokes, both.strokes);
}

TEST(Pipeline, RefusesAStateThatIsNotItsOwnAndWorksOnAsIfItHadNotSeenIt) {
  const PressOptions press = Press(1);
  const Machine machine = MachineFor(press);
  Line reference(machine), other(EveryForm(press)[2]);
  reference.Run(Rows(press));
  other.Run(Rows(press));
  const auto good = reference.pipeline->SaveState();
  auto torn = good;
  torn.resize(good.size() / 2);
  auto longer = good;
  longer.push_back(0);
  auto version = good;
  version[4] ^= 0xff;
  for (const auto& bad : {torn, longer, version, other.pipeline->SaveState(), std::vector<std::uint8_t>{}}) {
    Line line(machine);
    const Status status = line.pipeline->RestoreState(bad);
    ASSERT_FALSE(status);
    EXPECT_THAT(status.error().text, testing::HasSubstr("start without it"));
    line.Run(Rows(press));
    ExpectSame(line.strokes, reference.strokes);
  }
}

TEST(Pipeline, RecoversTheKnownParametersWithinItsIntervals) {
  for (std::uint64_t seed : {1, 2, 3}) {
    const PressOptions press = Press(seed, 180);
    Line line(MachineFor(press));
    line.Run(Rows(press));
    const double truth[] = {press.machine.K, press.machine.V0, press.machine.Q_vn, press.machine.y_0};
    const double limit[] = {0.04 * truth[0], 0.05 * truth[1], 0.005 * truth[2], 0.001};
    const auto& estimates = line.strokes.back().estimates;
    ASSERT_EQ(estimates.size(), 4u);
    for (int i = 0; i < 4; ++i) {
      const auto updated = [i](const StrokeRecord& r) {
        return !r.estimates.empty() && r.estimates[i].reason == EstimateReason::kUpdated;
      };
      EXPECT_GT(std::count_if(line.strokes.begin(), line.strokes.end(), updated), 10)
          << estimates[i].parameter;
      EXPECT_NEAR(estimates[i].value, truth[i], 3 * estimates[i].std)
          << estimates[i].parameter << " seed " << seed;
      EXPECT_NEAR(estimates[i].value, truth[i], limit[i]) << estimates[i].parameter << " seed " << seed;
    }
  }
}

TEST(Pipeline, AnHourOfStandstillChangesNothing) {
  PressOptions press = Press(1);
  Line line(MachineFor(press));
  line.Run(Rows(press));
  const auto state = line.pipeline->SaveState();
  const std::size_t strokes = line.strokes.size();
  RandomStream random(1);
  SampleBlock rest;
  const double mean[] = {25e5, 60e5, 210e5, 0.2, 0.008, 0.08, 313.15};
  const double std[] = {2.2e5, 1.1e5, 1.1e5, 1.2e-4, 6.8e-5, 0.001, 0.05};
  for (int block = 0; block < 1800; ++block) {
    rest.Resize(7, 1000);
    for (int k = 0; k < 1000; ++k) {
      rest.time[k] = 40 + 0.002 * (1000.0 * block + k);
      for (int s = 0; s < 7; ++s) {
        rest.signal[s][k] = mean[s] + std[s] * random.Normal();
        rest.quality[s][k] = quality::kGood;
      }
    }
    line.pipeline->Process(rest);
  }
  line.pipeline->Finish();
  EXPECT_EQ(line.strokes.size(), strokes);
  EXPECT_EQ(line.pipeline->SaveState(), state);
}

TEST(Pipeline, StrokesThatExciteNothingLeaveTheValuesAndSaySo) {
  const PressOptions press = Press(1, 120);
  Line line(MachineFor(press));
  line.Run(Rows(press));
  const auto before = line.strokes.back().estimates;
  SampleBlock rows = Rows(Monotonous(5));
  for (double& t : rows.time) t += 200;
  line.Run(rows);
  const auto after = line.strokes.back().estimates;
  for (int i : {0, 1}) {  // K' and V0 need pressure changes
    EXPECT_EQ(after[i].reason, EstimateReason::kNotExcited) << after[i].parameter;
    EXPECT_LT(after[i].last_excited, 200) << after[i].parameter;
    EXPECT_NEAR(after[i].value, before[i].value, 3 * before[i].std) << after[i].parameter;
  }
}

TEST(Pipeline, ASampleInsideAStrokeTouchesNoHeap) {
  const PressOptions press = Press(1, 60);
  Line line(MachineFor(press));
  line.Run(Rows(press));
  line.strokes.clear();
  line.strokes.reserve(1000);
  const SampleBlock rows = Rows(press);
  SampleBlock part;
  part.Resize(rows.signal.size(), 10);
  std::int64_t inside = 0, blocks = 0, at_ends = 0;
  for (std::size_t at = 0; at + 10 <= rows.rows(); at += 10) {
    for (std::size_t k = 0; k < 10; ++k) {
      part.time[k] = rows.time[at + k] + 100;
      for (std::size_t s = 0; s < rows.signal.size(); ++s) {
        part.signal[s][k] = rows.signal[s][at + k];
        part.quality[s][k] = rows.quality[s][at + k];
      }
    }
    const std::size_t strokes = line.strokes.size();
    const AllocationCount count;
    line.pipeline->Process(part);
    const std::int64_t allocations = count.value();
    if (line.strokes.size() != strokes) {  // the end of a stroke may
      at_ends += allocations;
      continue;
    }
    inside += allocations;
    ++blocks;
  }
  EXPECT_GT(blocks, 2000);
  EXPECT_GT(at_ends, 0);  // the counter counts
  EXPECT_EQ(inside, 0) << "allocations in " << blocks << " blocks of ten samples";
}

TEST(Pipeline, NeedsASamplePeriod) {
  const auto pipeline = Pipeline::Create(MachineFor(Press(1)), 0, {});
  ASSERT_FALSE(pipeline);
  EXPECT_THAT(pipeline.error().text, testing::HasSubstr("sample_period"));
}

}  // namespace
}  // namespace hydroscope
