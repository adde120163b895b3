#include "workbench/model/model_edit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "core/shown_width.h"
#include "studies/simulated_strokes.h"
#include "workbench/held_out_log.h"
#include "workbench/model/model_history_output.h"

namespace hydroscope {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

const std::string kFile = std::string(HYDROSCOPE_SOURCE_DIR) + "/machines/die_cushion.toml";

std::string Text(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

class ModelEdit : public testing::Test {
 protected:
  void SetUp() override {
    std::string name = testing::TempDir() + "hydroscope_XXXXXX";
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    folder_ = name;
    path_ = folder_ + "/press.toml";
    std::ofstream(path_, std::ios::binary) << Text(kFile);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::string folder_, path_;
};

ModelEvidence Judged(const Machine& machine, double rms) {
  ModelEvidence evidence;
  evidence.record = {
      machine.model_version,    ModelName(machine), machine.added_effects, "press.csv", 12, rms, 8e-6, "m3/s",
      {{"K", 1.2e9, 1e7, "Pa"}}};
  for (const std::string& id : machine.added_effects)
    if (id == "relief_valve") evidence.effect_values[id]["p_crack"] = 1.62e7;
  return evidence;
}

TEST_F(ModelEdit, TheFileKeepsItsCommentsAndSaysWhatEveryVersionAchieved) {
  const Machine before = *LoadMachine(path_);
  Machine next = *WithEffect(before, "relief_valve", 2);
  AddRecords(before, Judged(before, 2e-5), Judged(next, 9e-6), "", next);
  ASSERT_TRUE(WriteVersion(path_, path_, 1, next).has_value());
  const auto read = LoadMachine(path_);
  ASSERT_TRUE(read.has_value()) << read.error().text;
  EXPECT_EQ(*read, next);
  EXPECT_THAT(Text(path_), HasSubstr("# Die cushion of a deep-drawing press"));
  EXPECT_EQ(read->effect_values.at("relief_valve").at("p_crack"), 1.62e7);
  ASSERT_EQ(read->model_history.size(), 2u);
  EXPECT_EQ(read->model_history[1].name, "base + relief_valve");
  EXPECT_THAT(ModelHistoryText(*read), HasSubstr("base + relief_valve"));
  std::stringstream lines(ModelHistoryText(*read));
  for (std::string line; std::getline(lines, line);) EXPECT_LE(ShownWidth(line), kLineWidth) << line;
  EXPECT_THAT(LastStepText(*read), HasSubstr("1.2 -> 0.54 l/min"));
}

TEST_F(ModelEdit, EachChangeReplacesTheHistoryAndAddsOneVersion) {
  Machine machine = *LoadMachine(path_);
  for (const char* id : {"relief_valve", "internal_leakage"}) {
    Machine next = *WithEffect(machine, id, NextVersion(path_, machine));
    AddRecords(machine, std::nullopt, Judged(next, 1e-5), "", next);
    ASSERT_TRUE(WriteVersion(path_, path_, machine.model_version, next).has_value());
    machine = *LoadMachine(path_);
  }
  ASSERT_EQ(machine.model_history.size(), 3u);
  EXPECT_FALSE(machine.model_history[0].judged());
  EXPECT_EQ(machine.model_version, 3);
  const std::string text = Text(path_);
  EXPECT_EQ(text.find(kModelHistoryComment), text.rfind(kModelHistoryComment))
      << "the comment stands there once";
}

TEST_F(ModelEdit, TheVersionBeforeComesBackByteForByteAndNumbersAreNotUsedTwice) {
  const Machine before = *LoadMachine(path_);
  const Machine next = *WithEffect(before, "internal_leakage", NextVersion(path_, before));
  ASSERT_TRUE(WriteVersion(path_, path_, 1, next).has_value());
  const Machine back = *WithoutEffect(next, "internal_leakage", 3);
  const auto kept = FindKept(path_, next, back);
  ASSERT_TRUE(kept.has_value());
  EXPECT_EQ(kept->version, 1);
  ASSERT_TRUE(RestoreVersion(path_, 2, *kept).has_value());
  EXPECT_EQ(Text(path_), Text(kFile));
  EXPECT_EQ(NextVersion(path_, *LoadMachine(path_)), 3);
}

TEST_F(ModelEdit, AKeptVersionOfAnotherMachineIsNotBroughtBack) {
  const Machine before = *LoadMachine(path_);
  Machine next = *WithEffect(before, "internal_leakage", 2);
  next.geometry["A_A"].value *= 2;  // the file was edited meanwhile
  ASSERT_TRUE(WriteVersion(path_, path_, 1, next).has_value());
  EXPECT_FALSE(FindKept(path_, next, *WithoutEffect(next, "internal_leakage", 3)).has_value());
}

TEST_F(ModelEdit, WhatCannotBeAddedOrTakenOutIsNamed) {
  const Machine machine = *LoadMachine(path_);
  EXPECT_THAT(WithEffect(machine, "internal_leackage", 2).error().text,
              HasSubstr("did you mean 'internal_leakage'"));
  const std::string known = WithEffect(machine, "xyz", 2).error().text;
  EXPECT_THAT(known, HasSubstr("relief_valve"));
  EXPECT_EQ(known.find("relief_valve"), known.rfind("relief_valve")) << "each is listed once";
  EXPECT_THAT(WithoutEffect(machine, "relief_valve", 2).error().text, HasSubstr("is not part of the model"));
  const Machine next = *WithEffect(machine, "relief_valve", 2);
  EXPECT_THAT(WithEffect(next, "relief_valve", 3).error().text, HasSubstr("already part of the model"));
}

TEST_F(ModelEdit, AddingWhatDoesNotLowerTheErrorIsWarnedOf) {
  const Machine before = *LoadMachine(path_);
  const auto warnings = [&](double rms_after) {
    Machine next = *WithEffect(before, "relief_valve", 2);
    AddRecords(before, Judged(before, 2e-5), Judged(next, rms_after), "", next);
    return InEnglish(AddingWarnings(next, "relief_valve"));
  };
  EXPECT_THAT(warnings(4e-5), ElementsAre(HasSubstr("2.4 l/min with it and 1.2 l/min without")));
  EXPECT_THAT(warnings(2e-5), testing::SizeIs(1));
  EXPECT_THAT(warnings(1e-5), testing::IsEmpty());
}

TEST_F(ModelEdit, AddingWhatPhysicsForbidsOrChanceAloneGivesIsWarnedOf) {
  const Machine before = *LoadMachine(path_);
  const auto warnings = [&](double gain, const std::vector<std::string>& outside) {
    Machine next = *WithEffect(before, "relief_valve", 2);
    ModelEvidence was = Judged(before, 2e-5), is = Judged(next, 1.99e-5);
    for (const char* name : {"relief_valve.G", "V0"})
      is.record.parameters.push_back({name, -2e-11, 3e-12, "m3/(s Pa)"});
    is.outside_physics = outside;
    was.excess = Eigen::VectorXd::LinSpaced(20, 1.0, 2.0);
    is.excess = was.excess;
    for (int s = 0; s < 20; ++s) is.excess[s] -= gain + (s % 2 == 0 ? 0.01 : -0.01);
    AddRecords(before, was, is, "", next);
    return InEnglish(AddingWarnings(next, "relief_valve", was, is));
  };
  EXPECT_THAT(warnings(0.1, {}), testing::IsEmpty());
  EXPECT_THAT(warnings(0.001, {}), ElementsAre(HasSubstr("by no more than chance does")));
  EXPECT_THAT(warnings(0.1, {"relief_valve.G"}),
              ElementsAre(HasSubstr("the size of relief_valve comes out as")));
  EXPECT_THAT(warnings(0.1, {"V0"}), ElementsAre(HasSubstr("V0 comes out as")));
}

TEST(HeldOutLog, ALogIsHeldOutByPathOrFileName) {
  const std::vector<std::string> logs = {"runs/1bar.csv", "runs/3bar.csv"};
  const auto by_name = ChooseLogs(logs, "3bar.csv");
  ASSERT_TRUE(by_name.has_value());
  EXPECT_THAT(by_name->fitted, ElementsAre("runs/1bar.csv"));
  EXPECT_EQ(by_name->held_out, "runs/3bar.csv");
  EXPECT_EQ(ChooseLogs(logs, "other/5bar.csv")->fitted.size(), 2u);
  EXPECT_FALSE(ChooseLogs({"runs/1bar.csv"}, "1bar.csv").has_value());
  EXPECT_FALSE(ChooseLogs({"a/1bar.csv", "b/1bar.csv", "c.csv"}, "1bar.csv").has_value());
}

TEST(ModelRecord, TheErrorFallsWithTheEffectThatIsThere) {
  PressOptions press;
  press.seconds = 60;
  press.seed = 7;
  press.effects = {{"relief_valve", 5e-11, {{"crack", 163e5}}}};
  const Machine before = MachineFor(press);
  const Machine next = *WithEffect(before, "relief_valve", 2);
  const auto strokes = StrokesOf(SimulatePress(press), before, KeepSamples::kYes);
  ASSERT_TRUE(strokes.has_value());
  const auto judged_before = JudgeModel(before, *strokes, "press.csv"),
             judged_next = JudgeModel(next, *strokes, "press.csv");
  ASSERT_TRUE(judged_before && judged_next);
  EXPECT_LT(judged_next->record.rms_holdout, 0.9 * judged_before->record.rms_holdout);
  EXPECT_LT(judged_next->record.rms_holdout, 1.1 * judged_next->record.noise_floor);
  EXPECT_NEAR(judged_next->effect_values.at("relief_valve").at("p_crack"), 163e5, 5e5);
  EXPECT_EQ(judged_next->record.parameters.back().name, "relief_valve.G");
}

}  // namespace
}  // namespace hydroscope
