#include "page/watch/watched_machine.h"

#include <gtest/gtest.h>

#include "storage/storage_fixture.h"

namespace hydroscope {
namespace {

using namespace storage_test;

TEST(WatchedMachine, MayBeLookedAtFromBeforeItsFirstStrokeOn) {
  const Folder folder;
  Press press(folder.File());
  const auto watched =
      WatchedMachine::Create({press.database, folder.File(), nullptr, ""}, "press 7", press.machine);
  ASSERT_TRUE(watched) << watched.error().text;
  EXPECT_OK((*watched)->Refresh({}));
  EXPECT_EQ((*watched)->end(), 0);
  const RunInfo run = press.Begin("monday.csv");
  EXPECT_OK(press.database.StoreStrokes(run.id, MakeStrokes(0, 3)));
  EXPECT_OK((*watched)->Refresh({}));
  EXPECT_EQ((*watched)->end(), 3);
  EXPECT_TRUE((*watched)->json()["parameters"].empty()) << "another object knows the model";
}

}  // namespace
}  // namespace hydroscope
