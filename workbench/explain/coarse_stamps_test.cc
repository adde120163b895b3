// A log under time stamps that are not when its rows were sampled reads as the log under its true ones.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <functional>
#include <random>

#include "simulator/die_cushion/log_format.h"
#include "studies/simulated_strokes.h"
#include "workbench/explain/explain_log.h"
#include "workbench/fit_log.h"

namespace hydroscope {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

using Stamp = std::function<double(double)>;

class CoarseStamps : public testing::Test {
 protected:
  CoarseStamps() {
    options_.seconds = 60;
    options_.seed = 9;
    options_.effects = {{"internal_leakage", 4e-12, {}}};
    log_ = SimulatePress(options_);
    machine_ = MachineFor(options_);
    for (SignalSpec& signal : machine_.signals) {
      signal.column = signal.name;
      if (signal.name == "T_oil") signal.unit = "degC";
    }
    machine_.log.time_column = "t";
  }

  /// `times`: how often a logger writes each row, under stamps of its own.
  LogStrokes Read(const Stamp& stamp, int times = 1) const {
    const std::string path = testing::TempDir() + "/coarse_stamps_read.csv";
    std::string text(kPressLogHeader);
    for (std::size_t row = 0; row < log_.rows(); ++row) {
      PressRow line = log_.Row(row);
      for (int k = 0; k < times; ++k) {
        line.t = stamp(log_.t[row] + k * (log_.t[1] - log_.t[0]) / times);
        AppendPressLine(line, text);
      }
    }
    std::ofstream(path) << text;
    auto strokes = ReadStrokes(path, machine_, KeepSamples::kYes);
    EXPECT_TRUE(strokes) << (strokes ? "" : strokes.error().text);
    return strokes.value_or(LogStrokes{});
  }

  PressOptions options_;
  SimulatedLog log_;
  Machine machine_;
};

TEST_F(CoarseStamps, GiveTheParametersAndTheNameThatTrueStampsGive) {
  const auto fit = [](LogStrokes strokes) { return FitStrokes(std::move(strokes))->fit.theta; };
  const Eigen::VectorXd truth = fit(Read([](double t) { return t; }));
  std::mt19937 random(3);
  std::uniform_real_distribution<double> late(-0.0015, 0.0015);
  double last = 0;
  const std::vector<Stamp> loggers = {
      [](double t) { return std::floor(t / 0.01 + 1e-6) * 0.01; }, [](double t) { return std::floor(t); },
      [&](double t) { return last = std::max(last, t + std::max(0.0, late(random))); }};
  for (const Stamp& logger : loggers) {
    LogStrokes strokes = Read(logger);
    ASSERT_THAT(strokes.notes, ElementsAre(HasSubstr("taken as")));
    const Eigen::VectorXd theta = fit(strokes);
    EXPECT_LT(((theta - truth).array() / truth.array()).abs().maxCoeff(), 0.02) << strokes.notes.front();
    EXPECT_THAT(ExplainStrokes(std::move(strokes))->explanation.set, ElementsAre("internal_leakage"));
  }
}

TEST_F(CoarseStamps, OfALoggerThatRepeatsRowsChangeNothingEither) {
  const auto fit = [](LogStrokes strokes) { return FitStrokes(std::move(strokes))->fit.theta; };
  const auto exact = [](double t) { return t; };
  const Eigen::VectorXd truth = fit(Read(exact));
  for (const Stamp& stamp :
       {Stamp(exact), Stamp([](double t) { return std::floor(t / 0.01 + 1e-6) * 0.01; })}) {
    const LogStrokes strokes = Read(stamp, 3);
    ASSERT_THAT(strokes.notes, ElementsAre(HasSubstr("change together every 3 rows")));
    EXPECT_EQ(strokes.reader.rows, static_cast<std::int64_t>(log_.rows()));
    EXPECT_LT(((fit(strokes) - truth).array() / truth.array()).abs().maxCoeff(), 0.02);
  }
}

}  // namespace
}  // namespace hydroscope
