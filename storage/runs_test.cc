#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "storage/storage_fixture.h"

namespace hydroscope {
namespace {

using namespace storage_test;
using testing::ElementsAre;
using testing::HasSubstr;

TEST(Runs, AnInterruptedRunContinuesWhereItStopped) {
  const Folder folder;
  {
    Press press(folder.File());
    const auto run = press.Begin("a.csv");
    EXPECT_EQ(run.strokes, 0);
    EXPECT_OK(press.database.StoreStrokes(run.id, MakeStrokes(0, 12)));
  }
  Press again(folder.File());
  const auto run = again.Begin("a.csv");
  EXPECT_EQ(run.strokes, 12);
  EXPECT_FALSE(run.complete);
  EXPECT_OK(again.database.StoreStrokes(run.id, MakeStrokes(0, 20)));
  EXPECT_OK(again.database.FinishRun(run.id, "{\"rows\": 9}", {7}));
  const auto done = again.Begin("a.csv");
  EXPECT_EQ(done.id, run.id);
  EXPECT_TRUE(done.complete);
  EXPECT_EQ(done.strokes, 20);
  EXPECT_EQ(done.summary_json, "{\"rows\": 9}");
  EXPECT_EQ(done.model_version, 1);
}

TEST(Runs, AnInterruptedReplayLeavesTheSameContentAsAnUndisturbedOne) {
  const Folder folder;
  std::vector<std::string> digests;
  for (const std::int64_t stop : {150, 0, 1, 64, 100}) {
    const std::string file = folder.File(std::to_string(stop));
    if (stop < 150) {
      Press press(file);
      EXPECT_OK(press.database.StoreStrokes(press.Begin("a.csv").id, MakeStrokes(0, stop)));
    }
    Press press(file);
    const auto run = press.Begin("a.csv");
    EXPECT_OK(press.database.StoreStrokes(run.id, MakeStrokes(0, 150)));
    EXPECT_OK(press.database.FinishRun(run.id, "", {1}));
    digests.push_back(Value(press.database.ContentDigest()));
  }
  for (const auto& digest : digests) EXPECT_EQ(digest, digests[0]);
}

TEST(Runs, SequenceNumbersOfTheMachineGoOnFromRunToRun) {
  const Folder folder;
  Press press(folder.File());
  std::vector<std::int64_t> first;
  for (const auto& [log, strokes] : {std::pair("a.csv", 5), {"b.csv", 0}, {"c.csv", 3}, {"d.csv", 2}}) {
    const auto run = press.Begin(log);
    first.push_back(run.first_sequence);
    EXPECT_OK(press.database.StoreStrokes(run.id, MakeStrokes(0, strokes)));
    EXPECT_OK(press.database.FinishRun(run.id, "{}", {}));
  }
  EXPECT_THAT(first, ElementsAre(0, 5, 5, 8));
  std::int64_t expected = 0;
  for (const auto& point : Value(press.database.Trend(press.machine, "K")))
    EXPECT_EQ(point.sequence, expected++);
  EXPECT_EQ(expected, 10);
}

TEST(Runs, AnIncompleteRunIsAbandonedWhenAnotherBeginsAndKeepsItsStrokes) {
  const Folder folder;
  Press press(folder.File());
  const auto a = press.Begin("a.csv");
  EXPECT_OK(press.database.StoreStrokes(a.id, MakeStrokes(0, 5)));
  const auto b = press.Begin("b.csv");
  EXPECT_EQ(b.first_sequence, 5);
  EXPECT_OK(press.database.StoreStrokes(b.id, MakeStrokes(0, 2)));
  const auto runs = Value(press.database.Runs(press.machine));
  ASSERT_EQ(runs.size(), 2u);
  EXPECT_TRUE(runs[0].abandoned);
  EXPECT_EQ(runs[0].strokes, 5);
  EXPECT_FALSE(runs[1].abandoned);
  EXPECT_EQ(Value(press.database.Trend(press.machine, "K")).size(), 7u);

  const Status late = press.database.StoreStrokes(a.id, MakeStrokes(5, 6));
  ASSERT_FALSE(late.has_value());
  EXPECT_THAT(late.error().text, HasSubstr("abandoned"));
  const auto again = press.database.BeginRun(press.machine, press.version, "a.csv", "fingerprint of a.csv");
  ASSERT_FALSE(again.has_value());
  EXPECT_THAT(again.error().text, HasSubstr("a.csv stopped after 5 strokes"));
  EXPECT_OK(press.database.CheckIntegrity());
}

TEST(Runs, ARunWithoutStrokesLeavesNothingWhenAnotherBegins) {
  const Folder folder;
  Press press(folder.File());
  const auto a = press.Begin("a.csv");
  EXPECT_OK(press.database.StoreRaw(a.id, {"p"}, {1, 2}, {{3, 4}}, 1 << 20));
  EXPECT_OK(press.database.StoreStrokes(press.Begin("b.csv").id, MakeStrokes(0, 2)));
  const auto runs = Value(press.database.Runs(press.machine));
  ASSERT_EQ(runs.size(), 1u);
  EXPECT_EQ(runs[0].source, "b.csv");
  EXPECT_EQ(press.Begin("a.csv").first_sequence, 2);
}

TEST(Runs, TheStateOfTheLatestCompleteRunIsHandedOn) {
  const Folder folder;
  Press press(folder.File());
  const auto a = press.Begin("a.csv");
  EXPECT_FALSE(Value(press.database.PipelineStateBefore(a.id)).has_value());
  EXPECT_OK(press.database.FinishRun(a.id, "", {1, 0, 255}));
  const auto b = press.Begin("b.csv");
  EXPECT_THAT(Value(press.database.PipelineStateBefore(b.id)).value(), ElementsAre(1, 0, 255));
  EXPECT_OK(press.database.StoreStrokes(b.id, MakeStrokes(0, 1)));
  const auto c = press.Begin("c.csv");  // b was abandoned: what it learned is not complete
  EXPECT_THAT(Value(press.database.PipelineStateBefore(c.id)).value(), ElementsAre(1, 0, 255));
  EXPECT_OK(press.database.FinishRun(c.id, "", {}));
  const auto d = press.Begin("d.csv");
  EXPECT_THAT(Value(press.database.PipelineStateBefore(d.id)).value(), ElementsAre());
}

TEST(Runs, FinishingTwiceIsAllowedOnlyWithTheSameResult) {
  const Folder folder;
  Press press(folder.File());
  const auto run = press.Begin("a.csv");
  EXPECT_OK(press.database.FinishRun(run.id, "{}", {1}));
  EXPECT_OK(press.database.FinishRun(run.id, "{}", {1}));
  EXPECT_FALSE(press.database.FinishRun(run.id, "{}", {2}).has_value());
  EXPECT_FALSE(press.database.StoreStrokes(run.id, MakeStrokes(0, 1)).has_value());
}

TEST(Runs, AnUnknownRunMachineOrModelIsNamed) {
  const Folder folder;
  Press press(folder.File());
  EXPECT_THAT(press.database.StoreStrokes(9, {}).error().text, HasSubstr("has no run 9"));
  EXPECT_THAT(press.database.PutModelVersion(5, {}).error().text, HasSubstr("has no machine 5"));
  EXPECT_THAT(press.database.BeginRun(press.machine, 2, "a", "a").error().text,
              HasSubstr("no model version 2"));
}

}  // namespace
}  // namespace hydroscope
