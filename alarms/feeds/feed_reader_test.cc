#include "alarms/feeds/feed_reader.h"

#include <gtest/gtest.h>

#include <cmath>

#include "storage/storage_fixture.h"

namespace hydroscope {
namespace {

using namespace storage_test;

TEST(FeedReader, TellsEstimatesAsTheServiceStatesThem) {
  const Folder folder;
  Press press(folder.File());
  const RunInfo run = press.Begin("live");
  ASSERT_TRUE(press.database.StoreStrokes(run.id, MakeStrokes(0, 2)));
  const auto board = std::make_shared<HealthBoard>();
  board->TellStatements("press 7", {{.parameter = "K", .confounded = true, .why = Told("a leak")},
                                    {.parameter = "V0", .shared = 0.005, .why = {}}});
  FeedReader reader({"press 7"}, "", folder.File(), board);
  for (int look = 0; look < 2; ++look) {
    const auto axes = reader.Axes();
    ASSERT_TRUE(axes) << axes.error().text;
    const Estimate &k = axes->front().estimates[0].estimate, &v = axes->front().estimates[1].estimate;
    EXPECT_EQ(k.std, 2e7);
    EXPECT_EQ(k.reason, EstimateReason::kConfounded);
    EXPECT_NEAR(v.std, std::hypot(1e-5, 0.005 * v.value), 1e-12) << "once, however often it is read";
    EXPECT_EQ(v.reason, EstimateReason::kUpdated);
  }
}

}  // namespace
}  // namespace hydroscope
