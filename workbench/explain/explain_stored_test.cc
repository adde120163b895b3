#include "workbench/explain/explain_stored.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <optional>

#include "studies/simulated_strokes.h"
#include "workbench/history/history_output.h"

namespace hydroscope {
namespace {

/// Simulated logs, one after another, in a database of their own.
class ExplainStoredTest : public testing::Test {
 protected:
  ExplainStoredTest() {
    const std::string path =
        testing::TempDir() + testing::UnitTest::GetInstance()->current_test_info()->name() + ".db";
    for (const char* suffix : {"", "-wal", "-shm"}) std::filesystem::remove(path + suffix);
    database_.emplace(std::move(*Database::Open(path)));
    machine_ = MachineFor(PressOptions{});
    machine_.log.sample_period = PressOptions{}.sample_period;
    id_ = database_->MachineId(machine_.name).value();
  }

  void Store(std::uint64_t seed, double leak) {
    PressOptions press;
    press.seconds = 60;
    press.seed = seed;
    press.effects = {{"internal_leakage", leak, {}}};
    const auto log = StrokesOf(SimulatePress(press), machine_);
    ASSERT_TRUE(log) << log.error().text;
    const int version =
        database_->PutModelVersion(id_, {1, FormatMachine(machine_), log->model->ColumnNames()}).value();
    const auto run = database_->BeginRun(id_, version, "log", std::to_string(seed));
    ASSERT_TRUE(run) << run.error().text;
    ASSERT_TRUE(database_->StoreStrokes(run->id, log->strokes));
    strokes_ += static_cast<std::int64_t>(log->strokes.size());
  }

  std::optional<Database> database_;
  Machine machine_;
  std::int64_t id_ = 0, strokes_ = 0;
};

/// No size of it describes all strokes, and no effect beside it explains what one size leaves.
TEST_F(ExplainStoredTest, AnEffectOfTheModelThatGrowsInSeveralStepsIsNamed) {
  machine_.added_effects = {"internal_leakage"};
  for (const auto& [seed, leak] : {std::pair{1, 3e-12}, {2, 3e-12}, {3, 5e-12}, {4, 7e-12}, {5, 9e-12}})
    Store(static_cast<std::uint64_t>(seed), leak);
  const auto stored = ExplainStored(*database_, "", {machine_.name, id_, 0, strokes_}, machine_, {});
  ASSERT_TRUE(stored) << stored.error().text;
  ASSERT_TRUE(stored->sides.has_value());
  EXPECT_EQ(stored->change->by, "internal_leakage.G");
  EXPECT_THAT(ChangeSentence(*stored, CountedWordsOf(machine_)),
              testing::HasSubstr("internal_leakage.G moves on"));
  EXPECT_EQ(stored->sides->after.explanation.verdict, Verdict::kNamed) << ChangeText(*stored->sides);
  EXPECT_THAT(stored->sides->after.explanation.set, testing::ElementsAre("internal_leakage"));
  EXPECT_TRUE(stored->sides->appeared.empty()) << "it was there";
}

}  // namespace
}  // namespace hydroscope
