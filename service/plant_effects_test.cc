#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "service/benchmarks/simulated_strokes.h"
#include "service/drift_text.h"
#include "service/explain_log.h"
#include "service/machine_model.h"
#include "service/what_to_record.h"

namespace hydroscope {
namespace {

constexpr double kSeconds = 120;

/// An imperfection of the simulator and the parameter of the library's law that it should come out as.
struct PlantCase {
  std::string id;
  double size = 0;   ///< as the simulator takes it
  double truth = 0;  ///< as the library's law counts it
  std::uint64_t seed = 11;
};

/// Relative rate at the middle of the log of what moves by the share `change` of its beginning.
double RateOf(double change) { return change / kSeconds / (1 + 0.5 * change); }

std::vector<PlantCase> PlantCases() {
  return {{"return_line_resistance", 1e9, 1e9},
          {"tank_pressure", 5e5, 5e5},
          {"laminar_edge", 20e5, 4e12},
          {"pressure_dependent_bulk_modulus", 11, 11},
          {"leakage_temperature", 4e-12, 4e-12},
          {"periodic_disturbance", 2e-5, 2e-5},
          {"K_drift", -0.20, RateOf(-0.20)},
          {"V0_drift", 0.30, RateOf(0.30)},
          {"Q_vn_drift", 0.04, RateOf(0.04)},
          {"y_0_drift", 0.004, 0.004 / kSeconds},
          {"pressure_offset_drift", 8e5, 8e5 / kSeconds},
          {"pressure_signal_lag", 0.005, 0.005},
          {"spool_signal_lag", 0.005, 0.005},
          {"position_signal_lag", 0.005, 0.005}};
}

PressOptions OptionsFor(const PlantCase& plant) {
  PressOptions options;
  options.seconds = kSeconds;
  options.seed = plant.seed;
  if (plant.id == "leakage_temperature") {
    options.oil_start = 300.15;
    options.oil_end = 325.15;
  }
  options.imperfections = {{plant.id, plant.size, {}, ""}};
  return options;
}

Result<LogStrokes> StrokesOfCase(const PlantCase& plant) {
  const PressOptions options = OptionsFor(plant);
  return StrokesOf(SimulatePress(options), MachineFor(options), KeepSamples::kYes);
}

class PlantEffect : public testing::TestWithParam<PlantCase> {};
INSTANTIATE_TEST_SUITE_P(OfTheLibrary, PlantEffect, testing::ValuesIn(PlantCases()),
                         [](const auto& test) { return test.param.id; });

TEST_P(PlantEffect, IsRecoveredWithinThreeStandardDeviations) {
  auto strokes = StrokesOfCase(GetParam());
  ASSERT_TRUE(strokes) << strokes.error().text;
  strokes->machine.added_effects = {GetParam().id};
  const auto model = FitMachineModel(*strokes);
  ASSERT_TRUE(model) << model.error().text;
  const EffectEstimate& size = model->fit.effects.front();
  EXPECT_TRUE(std::isfinite(size.std) && size.std > 0);
  EXPECT_LE(std::abs(size.size - GetParam().truth), 3 * size.std)
      << size.size << " +- " << size.std << ", truth " << GetParam().truth;
}

TEST_P(PlantEffect, IsNamedOrOneOfTheClassThatStrokesCannotTellApart) {
  auto strokes = StrokesOfCase(GetParam());
  ASSERT_TRUE(strokes) << strokes.error().text;
  const auto result = ExplainStrokes(std::move(*strokes));
  ASSERT_TRUE(result) << result.error().text;
  EXPECT_THAT(result->explanation.set, testing::Contains(GetParam().id))
      << VerdictName(result->explanation.verdict) << " " << result->explanation.doubt << " "
      << result->explanation.remainder_law
      << ", first in the ranking: " << result->explanation.ranking.front().id;
  if (result->explanation.verdict == Verdict::kAmbiguous) EXPECT_TRUE(WhatToRecord(*result));
}

}  // namespace
}  // namespace hydroscope
