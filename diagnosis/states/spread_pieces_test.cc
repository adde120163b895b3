#include "diagnosis/states/spread_pieces.h"

#include <gtest/gtest.h>

namespace hydroscope {
namespace {

/// Means of 8 rows each, with one more row at the end; signal 0 counts the rows.
Episode OfMeans(int readings) {
  Episode episode;
  episode.mean_rows = 8;
  const int rows = 8 * readings + 1;
  episode.signal.resize(rows, 1);
  for (int row = 0; row < rows; ++row) {
    episode.time.push_back(1e-3 * row);
    episode.signal(row, 0) = row;
  }
  return episode;
}

TEST(ShortRuns, BeginWhereTheOneBeforeEndsAndLoseNoReading) {
  const std::vector<Episode> episodes = {OfMeans(110)};
  const std::vector<Episode> runs = ShortRuns(episodes, 25);
  ASSERT_EQ(runs.size(), 4);
  int readings = 0;
  for (std::size_t r = 0; r < runs.size(); ++r) {
    EXPECT_EQ(runs[r].mean_rows, 8);
    EXPECT_EQ((runs[r].rows() - 1) % 8, 0) << r;
    EXPECT_EQ(runs[r].signal(0, 0), runs[r].first_row) << r;
    if (r > 0) {
      EXPECT_EQ(runs[r].time.front(), runs[r - 1].time.back()) << r;
    }
    readings += (runs[r].rows() - 1) / 8;
  }
  EXPECT_EQ(readings, 110);
  EXPECT_EQ(runs.back().time.back(), episodes.front().time.back());
}

TEST(ShortRuns, LeaveShortEpisodesWhole) {
  EXPECT_TRUE(ShortRuns(std::vector<Episode>{OfMeans(40)}, 25).empty());
}

TEST(SpreadOver, ChoosesFromAllOverAndNeverMoreThanThereAre) {
  EXPECT_EQ(SpreadOver(15, 5), (std::vector<std::size_t>{1, 4, 7, 10, 13}));
  EXPECT_EQ(SpreadOver(3, 5), (std::vector<std::size_t>{0, 1, 2}));
}

}  // namespace
}  // namespace hydroscope
