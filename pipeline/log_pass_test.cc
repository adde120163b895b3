#include "pipeline/log_pass.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "pipeline/batch_fit.h"
#include "pipeline/log_faults/broken_strokes.h"
#include "studies/simulated_strokes.h"

namespace hydroscope {
namespace {

/// A log in memory.
class RowsReader : public LogReader {
 public:
  RowsReader(SampleBlock rows, double period) : rows_(std::move(rows)), period_(period) {}
  Result<std::size_t> Read(SampleBlock& block, std::size_t max_rows) override {
    const std::size_t rows = std::min(max_rows, rows_.rows() - at_);
    block.Resize(rows_.signal.size(), rows);
    for (std::size_t k = 0; k < rows; ++k, ++at_) {
      block.time[k] = rows_.time[at_];
      for (std::size_t c = 0; c < rows_.signal.size(); ++c) {
        block.signal[c][k] = rows_.signal[c][at_];
        block.quality[c][k] = quality::kGood;
      }
    }
    return rows;
  }
  double Progress() const override { return 1; }
  double SamplePeriod() const override { return period_; }
  const LogCounters& counters() const override { return counters_; }

 private:
  SampleBlock rows_;
  double period_;
  LogCounters counters_;
  std::size_t at_ = 0;
};

/// Rows of a press of which the first half was written twice, under stamps that go on.
SampleBlock WrittenTwice(const PressOptions& options, const Machine& machine) {
  SimulatedLog log = SimulatePress(options), twice;
  for (const std::size_t rows : {log.rows() / 2, log.rows()})
    for (std::size_t k = 0; k < rows; ++k) twice.Append(log.Row(k));
  for (std::size_t k = 0; k < twice.rows(); ++k)
    twice.t[k] = static_cast<double>(k) * log.truth.options.sample_period;
  return RowsOf(twice, machine);
}

TEST(LogPass, RowsThatWereWrittenTwiceAreNoFurtherEvidence) {
  PressOptions options;
  options.seconds = 40;
  const Machine machine = MachineFor(options);
  const auto pass_of = [&](bool distrust_logger) {
    RowsReader reader(WrittenTwice(options, machine), 0.002);
    LogPassHooks hooks;
    hooks.distrust_logger = distrust_logger;
    return *PassLog(reader, machine, nullptr, "reading", hooks);
  };
  EXPECT_NEAR(static_cast<double>(pass_of(true).copied_rows), 10000, 40);
  EXPECT_GT(pass_of(true).summary.flagged.at("p_A").at("duplicate"), 9900);
  EXPECT_EQ(pass_of(false).copied_rows, 0) << "as the live service";
}

/// Ten readings of every 200 of p_A lie on the straight line that a logger drew for those that it did not get.
TEST(LogPass, ReadingsThatALoggerDrewAreNone) {
  PressOptions options;
  options.seconds = 40;
  const Machine machine = MachineFor(options);
  SimulatedLog log = SimulatePress(options);
  for (std::size_t k = 100; k + 11 < log.rows(); k += 200)
    for (std::size_t i = 1; i <= 10; ++i)
      log.p_A[k + i] = log.p_A[k] + (log.p_A[k + 11] - log.p_A[k]) * static_cast<double>(i) / 11;
  const auto flagged = [&](bool distrust_logger) {
    RowsReader reader(RowsOf(log, machine), 0.002);
    LogPassHooks hooks;
    hooks.distrust_logger = distrust_logger;
    return PassLog(reader, machine, nullptr, "reading", hooks)->summary.flagged;
  };
  const auto drawn = flagged(true);
  EXPECT_NEAR(static_cast<double>(drawn.at("p_A").at("interpolated")), 1000, 100);
  EXPECT_FALSE(drawn.contains("z"));
  EXPECT_TRUE(flagged(false).empty()) << "as the live service";
}

/// Reads a press whose rows went through `change`.
LogPass PassOf(const std::function<void(SimulatedLog&)>& change) {
  PressOptions options;
  options.seconds = 40;
  const Machine machine = MachineFor(options);
  SimulatedLog log = SimulatePress(options);
  change(log);
  RowsReader reader(RowsOf(log, machine), options.sample_period);
  return *PassLog(reader, machine, nullptr, "reading");
}

TEST(LogPass, APositionWhoseCounterOverflowsCarriesNoVerdict) {
  const LogPass pass = PassOf([](SimulatedLog& log) {
    for (double& z : log.z) z -= 0.065536 * std::floor(z / 0.065536);
  });
  EXPECT_THAT(pass.no_verdict.english, testing::HasSubstr("signal z (column z) jumps"));
  EXPECT_THAT(pass.no_verdict.german, testing::HasSubstr("ein Zähler, der überläuft"));
}

TEST(LogPass, PositionsThatAreSetAnewOnceOrHeldByTheLoggerOrOffInSingleRowsAreJudged) {
  const auto nothing = [](SimulatedLog&) {};
  const auto set_anew = [](SimulatedLog& log) {
    for (std::size_t k = log.rows() / 2; k < log.rows(); ++k) log.z[k] += 0.02;
  };
  const auto held = [](SimulatedLog& log) {
    for (std::size_t k = 0; k < log.rows(); ++k) log.z[k] = log.z[k - k % 10];
  };
  const auto off = [](SimulatedLog& log) {
    for (std::size_t k = 0; k < log.rows(); k += 500) log.z[k] = 0;
  };
  for (const std::function<void(SimulatedLog&)>& change :
       std::vector<std::function<void(SimulatedLog&)>>{nothing, set_anew, held, off}) {
    const LogPass pass = PassOf(change);
    EXPECT_EQ(pass.no_verdict.english, "");
    EXPECT_TRUE(pass.echoes.empty());
    EXPECT_TRUE(pass.swapped.empty());
  }
}

TEST(LogPass, PressuresInOneAnothersPlaceAreTold) {
  const auto told_of = [](std::vector<double> SimulatedLog::*one, std::vector<double> SimulatedLog::*other) {
    return PassOf([&](SimulatedLog& log) { std::swap(log.*one, log.*other); }).swapped;
  };
  EXPECT_THAT(told_of(&SimulatedLog::p_B, &SimulatedLog::p_0),
              testing::ElementsAre(testing::Field(
                  &Told::english, testing::MatchesRegex("p_B .* stands above p_0 .* swapped .*"))));
  EXPECT_THAT(told_of(&SimulatedLog::p_A, &SimulatedLog::p_B),
              testing::ElementsAre(testing::Field(
                  &Told::english, testing::MatchesRegex("p_A .* while oil is pressed out .* swapped .*"))));
}

TEST(LogPass, OneReadingForTwoPressuresIsTold) {
  const LogPass pass = PassOf([](SimulatedLog& log) { log.p_0 = log.p_B; });
  EXPECT_THAT(pass.swapped,
              testing::ElementsAre(testing::Field(
                  &Told::english, testing::MatchesRegex("p_B .* and p_0 .* have the same reading .*"))));
  const LogPass at_rest = PassOf([](SimulatedLog& log) {
    log.p_0.assign(log.rows(), 0.0);
    log.p_B = log.p_0;
  });
  EXPECT_THAT(at_rest.swapped,
              testing::Each(testing::Field(&Told::english, testing::Not(testing::HasSubstr("same")))));
}

/// Of p_A the logger drew every second quarter of a second from the third stroke on: no stroke is whole there.
TEST(LogPass, StrokesThatBadReadingsBreakUpLeaveTheRestNoWordForAll) {
  PressOptions options;
  options.seconds = 40;
  const Machine machine = MachineFor(options);
  const auto sentence = [&](std::size_t of_period) {
    SimulatedLog log = SimulatePress(options);
    for (std::size_t k = log.rows() / 4; k + 126 < log.rows(); k += 250)
      for (std::size_t i = 1; i <= of_period; ++i)
        log.p_A[k + i] = log.p_A[k] + (log.p_A[k + 126] - log.p_A[k]) * static_cast<double>(i) / 126;
    RowsReader reader(RowsOf(log, machine), options.sample_period);
    StrokeCollector collector(machine, KeepSamples::kNo);
    auto pipeline = Pipeline::Create(machine, options.sample_period, collector.Sink());
    const LogPass pass = *PassLog(reader, machine, pipeline->get(), "reading");
    const LogStrokes strokes = collector.Finish(**pipeline);
    return BrokenUp(pass.channels, machine, std::ssize(strokes.strokes), strokes.discarded_strokes).english;
  };
  EXPECT_EQ(sentence(0), "");
  EXPECT_THAT(sentence(125), testing::HasSubstr("those of p_A) break up strokes"));
}

TEST(LogPass, ASpoolThatRepeatsItsCommandIsNotMeasured) {
  const LogPass pass = PassOf([](SimulatedLog& log) {
    for (std::size_t k = 0; k < log.rows(); ++k) log.y_v[k] = 0.01 + 0.1 * log.U_v[k];
  });
  ASSERT_EQ(pass.echoes.size(), 1U);
  EXPECT_THAT(pass.echoes.front().Sentence().english, testing::HasSubstr("y_v repeats U_v"));
}

}  // namespace
}  // namespace hydroscope
