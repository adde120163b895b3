// What diagnosis/free_run.h gives for models as the workbench fits them.
#include "diagnosis/free_run.h"

#include <gtest/gtest.h>

#include <cmath>

#include "diagnosis/remainder/residuals.h"
#include "studies/simulated_strokes.h"
#include "workbench/model/machine_model.h"

namespace hydroscope {
namespace {

LogStrokes Strokes(std::vector<EffectSetting> effects) {
  PressOptions press;
  press.seconds = 30;
  press.seed = 11;
  press.effects = std::move(effects);
  return *StrokesOf(SimulatePress(press), MachineFor(press), KeepSamples::kYes);
}

double MeanRms(const LogStrokes& log) {
  const auto model = FitMachineModel(log);
  EXPECT_TRUE(model.has_value());
  const auto run =
      FreeRun(*model->structure, log.stretches, log.window, ColumnWeights(*model->structure, model->fit));
  EXPECT_TRUE(run.has_value());
  double squares = 0;
  for (const FreeRunStroke& stroke : *run) squares += stroke.rms * stroke.rms;
  return std::sqrt(squares / static_cast<double>(run->size()));
}

TEST(FreeRun, TheModelOfAHealthyMachineRunsItsPressureByItself) {
  EXPECT_LT(MeanRms(Strokes({})), 3e5) << "of some 140 bar";
}

TEST(FreeRun, AnEffectTheModelMissesShowsInThePressure) {
  EXPECT_GT(MeanRms(Strokes({{"relief_valve", 6e-11, {{"crack", 150e5}}}})), 2 * MeanRms(Strokes({})));
}

TEST(FreeRun, WithTheEffectInTheModelThePressureIsRightAgain) {
  LogStrokes log = Strokes({{"internal_leakage", 8e-12, {}}});
  const double without = MeanRms(log);
  log.machine.added_effects = {"internal_leakage"};
  EXPECT_LT(MeanRms(log), without);
}

}  // namespace
}  // namespace hydroscope
