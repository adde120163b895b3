#include "page/watch/trend_cache.h"

#include <gmock/gmock.h>

#include <future>

#include "core/expect_ok_fixture.h"
#include "storage/storage_fixture.h"

namespace hydroscope {
namespace {

using namespace storage_test;

/// More strokes than are read at once, each with one parameter and next to no Gram.
class TrendCacheTest : public testing::Test {
 protected:
  static constexpr std::int64_t kStrokes = TrendCache::kMostRead + 10'000;

  void SetUp() override {
    const RunInfo run = press_.Begin("year.csv");
    for (std::int64_t first = 0; first < kStrokes; first += 5000) {
      std::vector<StrokeRecord> strokes;
      for (std::int64_t k = first; k < first + 5000; ++k) {
        StrokeRecord stroke = MakeStroke(k, 1);
        stroke.estimates.resize(1);
        strokes.push_back(std::move(stroke));
      }
      ASSERT_OK(press_.database.StoreStrokes(run.id, strokes));
    }
  }
  TrendPicture Picture(TrendCache& cache, std::int64_t first, std::int64_t end, std::int64_t bins) {
    return Value(cache.Picture(press_.database, press_.machine, "K", first, end, bins));
  }

  Folder folder_;
  Press press_{folder_.File(), 1};
};

TEST_F(TrendCacheTest, ALongTrendIsGlancedAtFirstAndThenExact) {
  std::promise<void> ready;
  TrendCache cache(folder_.File(), [&] { ready.set_value(); });
  const TrendPicture glance = Picture(cache, 0, kStrokes, 200);
  EXPECT_FALSE(glance.exact);
  EXPECT_LE(glance.bins.size(), 201u);
  ready.get_future().wait();
  const TrendPicture exact = Picture(cache, 0, kStrokes, 200);
  EXPECT_TRUE(exact.exact);
  std::int64_t next = 0, values = 0;
  double low = 1e300, high = -1e300;
  for (const TrendBin& bin : exact.bins) {
    EXPECT_EQ(bin.first, next) << "bins follow each other";
    next = bin.last + 1;
    values += bin.values;
    low = std::min(low, bin.low);
    high = std::max(high, bin.high);
  }
  EXPECT_EQ(values, kStrokes);
  double true_low = 1e300, true_high = -1e300;
  for (std::int64_t k = 0; k < kStrokes; ++k) {
    const double value = MakeStroke(k, 1).estimates[0].value;
    true_low = std::min(true_low, value);
    true_high = std::max(true_high, value);
  }
  EXPECT_EQ(low, true_low);
  EXPECT_EQ(high, true_high);
}

TEST_F(TrendCacheTest, WhatSeveralReadersGlanceAtIsWhatOneWould) {
  constexpr std::int64_t kWidth = 300, kMost = 3;
  const auto several = Value(GlancedBins(folder_.File(), press_.machine, "K", 0, kStrokes, kWidth, kMost));
  const auto one = Value(press_.database.TrendBins(press_.machine, "K", 0, kStrokes, kWidth, kMost));
  ASSERT_EQ(several.size(), one.size());
  for (std::size_t k = 0; k < one.size(); ++k) {
    EXPECT_EQ(several[k].first, one[k].first);
    EXPECT_EQ(several[k].last, one[k].last);
    EXPECT_EQ(several[k].mean, one[k].mean);
  }
}

TEST_F(TrendCacheTest, AShortPieceIsExactAtOnce) {
  TrendCache cache(folder_.File(), [] {});
  const TrendPicture picture = Picture(cache, 1000, 1010, 500);
  EXPECT_TRUE(picture.exact);
  EXPECT_EQ(picture.width, 1);
  EXPECT_EQ(picture.bins.size(), 10u);
}

TEST(TrendBins, JoinedTheyWeighTheirValues) {
  const TrendBin a{1, 0, 9, 10, 0, 9, 1, 5, 3, 0.1, 300}, b{1, 10, 19, 5, 10, 19, 2, 8, 6, 0.4, 310};
  const TrendBin joined = JoinedBins(a, b);
  EXPECT_EQ(joined.first, 0);
  EXPECT_EQ(joined.last, 19);
  EXPECT_EQ(joined.values, 15);
  EXPECT_EQ(joined.low, 1);
  EXPECT_EQ(joined.high, 8);
  EXPECT_DOUBLE_EQ(joined.mean, 4);
  EXPECT_DOUBLE_EQ(joined.std, 0.2);
  EXPECT_DOUBLE_EQ(joined.oil_temperature, 305);
  TrendBin empty = b;
  empty.values = 0;
  empty.low = empty.high = empty.mean = empty.std = std::nan("");
  EXPECT_EQ(JoinedBins(a, empty).mean, a.mean);
  EXPECT_EQ(JoinedBins(empty, a).low, a.low);
}

}  // namespace
}  // namespace hydroscope
