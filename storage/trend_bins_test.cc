#include <gmock/gmock.h>

#include "storage/storage_fixture.h"

namespace hydroscope {
namespace {

using namespace storage_test;

class TrendBinsTest : public testing::Test {
 protected:
  /// Two logs, of 100 and of 50 strokes, the second one later.
  void SetUp() override {
    const RunInfo first = press_.Begin("monday.csv");
    ASSERT_TRUE(press_.database.StoreStrokes(first.id, MakeStrokes(0, 100)));
    ASSERT_TRUE(press_.database.FinishRun(first.id, "{}", {}));
    auto later = MakeStrokes(0, 50, 6, 2);
    for (StrokeRecord& stroke : later) stroke.summary.begin += 1000, stroke.summary.end += 1000;
    ASSERT_TRUE(press_.database.StoreStrokes(press_.Begin("tuesday.csv").id, later));
  }
  std::vector<TrendBin> Bins(const std::string& parameter, std::int64_t first, std::int64_t end,
                             std::int64_t width, std::int64_t most = 0) {
    return Value(press_.database.TrendBins(press_.machine, parameter, first, end, width, most));
  }

  Folder folder_;
  Press press_{folder_.File()};
};

TEST_F(TrendBinsTest, BinsHoldLowestAndHighestValueOfTheirStrokes) {
  const auto points = Value(press_.database.Trend(press_.machine, "K"));
  std::int64_t strokes = 0;
  for (const TrendBin& bin : Bins("K", 0, 150, 32)) {
    double low = 1e300, high = -1e300, sum = 0, count = 0;
    for (const TrendPoint& point : points) {
      if (point.sequence < bin.first || point.sequence > bin.last) continue;
      low = std::min(low, point.estimate.value);
      high = std::max(high, point.estimate.value);
      sum += point.estimate.value;
      ++count;
      EXPECT_EQ(point.run, bin.run);
      EXPECT_GE(point.time, bin.begin);
      EXPECT_LE(point.time, bin.end);
    }
    EXPECT_EQ(bin.low, low);
    EXPECT_EQ(bin.high, high);
    EXPECT_NEAR(bin.mean, sum / count, 1e-9 * sum / count);
    EXPECT_EQ(bin.std, 2e7);
    EXPECT_EQ(bin.values, bin.last - bin.first + 1);
    strokes += bin.values;
  }
  EXPECT_EQ(strokes, 150);
}

TEST_F(TrendBinsTest, NoBinReachesOverTheEndOfARun) {
  const auto bins = Bins("K", 90, 150, 40);
  ASSERT_EQ(bins.size(), 3u);
  EXPECT_EQ(bins[0].last, 99);
  EXPECT_EQ(bins[1].first, 100);
  EXPECT_EQ(bins[1].last, 139);
  EXPECT_EQ(bins[2].last, 149);
}

TEST_F(TrendBinsTest, SingleStrokesAreThePointsOfTheTrend) {
  const auto points = Value(press_.database.Trend(press_.machine, "V0", 95, 105));
  const auto bins = Bins("V0", 95, 105, 1);
  ASSERT_EQ(bins.size(), points.size());
  for (std::size_t i = 0; i < bins.size(); ++i) {
    EXPECT_EQ(bins[i].first, points[i].sequence);
    EXPECT_EQ(bins[i].mean, points[i].estimate.value);
    EXPECT_EQ(bins[i].end, points[i].time);
  }
}

TEST_F(TrendBinsTest, AGlanceLooksAtTheFirstStrokesOfEachBinOnly) {
  const auto bins = Bins("K", 0, 100, 50, 2);
  ASSERT_EQ(bins.size(), 2u);
  EXPECT_EQ(bins[1].values, 2);
  EXPECT_EQ(bins[1].last, 99);
}

TEST_F(TrendBinsTest, TheOilIsThatOfTheEstimateAndElseThatOfTheStroke) {
  EXPECT_EQ(Bins("Q_vn", 4, 5, 1).front().oil_temperature, MakeStroke(4).estimates[2].oil_temperature);
  EXPECT_EQ(Bins("K", 4, 5, 1).front().oil_temperature, MakeStroke(4).summary.oil_temperature);
}

TEST_F(TrendBinsTest, AnUnknownParameterHasStrokesWithoutValues) {
  const auto bins = Bins("K'; DROP TABLE run; --", 0, 150, 100);
  ASSERT_EQ(bins.size(), 2u);
  EXPECT_EQ(bins[0].values, 0);
  EXPECT_TRUE(std::isnan(bins[0].low));
}

TEST_F(TrendBinsTest, ATimeLeadsToItsStrokeOverSeveralRuns) {
  const auto near = [&](double time) { return Value(press_.database.SequenceNear(press_.machine, time)); };
  EXPECT_EQ(near(-5), 0);
  EXPECT_EQ(near(MakeStroke(42).summary.end), 42);
  EXPECT_EQ(near(MakeStroke(42).summary.end + 0.01), 43);
  EXPECT_EQ(near(500), 100);
  EXPECT_EQ(near(1000 + MakeStroke(7).summary.end), 107);
  EXPECT_EQ(near(1e9), 150);
}

}  // namespace
}  // namespace hydroscope
