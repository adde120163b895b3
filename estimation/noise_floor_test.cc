#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "estimation/analytic_stroke_fixture.h"
#include "estimation/gram_fit.h"
#include "estimation/stroke_accumulator.h"
#include "estimation/stroke_segmenter.h"
#include "simulator/die_cushion/press.h"

namespace hydroscope {
namespace {

std::vector<SimulatedLog> Logs(const SensorNoise& noise, int count) {
  PressOptions options;
  options.seconds = 60;
  options.noise = noise;
  std::vector<SimulatedLog> logs;
  for (int log = 0; log < count; ++log) {
    options.seed = 1 + static_cast<std::uint64_t>(log);
    logs.push_back(SimulatePress(options));
  }
  return logs;
}

/// Grams of the strokes of simulated logs; the simulated press has the geometry of the analytic machine.
std::vector<StrokeGram> GramsOf(const std::vector<SimulatedLog>& logs, const WindowSamples& window,
                                const std::shared_ptr<const ModelStructure>& model) {
  Machine machine = AnalyticMachine();
  machine.gate.bounds = {{"y_v", false, 0.04, std::nullopt}, {"z", true, std::nullopt, -0.004}};
  std::vector<StrokeGram> grams;
  for (const SimulatedLog& data : logs) {
    SampleBlock rows;
    rows.Resize(machine.signals.size(), data.rows());
    rows.time = data.t;
    rows.signal = {data.p_A, data.z, data.y_v, data.p_B, data.p_0, data.T_oil};
    for (auto& flags : rows.quality) std::fill(flags.begin(), flags.end(), quality::kGood);
    SpanEquationBuilder builder(model, window);
    StrokeAccumulator accumulator(model->column_count());
    StrokeSegmenter segmenter(
        machine, model, window,
        {[&](Stretch& s, double begin) { accumulator.Add(builder.Build(s, begin)); },
         [&](const StrokeSummary&) { grams.push_back(accumulator.Take()); }, [&] { accumulator.Take(); }});
    segmenter.Process(rows);
    segmenter.Finish();
  }
  return grams;
}

/// Flow error of the true parameters over the noise floor.
double ErrorOverFloor(const std::vector<SimulatedLog>& logs, double span) {
  const auto model = *BuildModel(AnalyticMachine());
  WindowSpec spec;
  spec.span = span;
  const WindowSamples window = WindowSamples::From(spec, 0.002);
  const auto grams = GramsOf(logs, window, model);
  std::vector<int> columns(4);
  std::iota(columns.begin(), columns.end(), 0);
  const Eigen::VectorXd theta = AnalyticStroke::Theta();
  NormalEquations flow;
  for (const StrokeGram& gram : grams) flow += FlowEquations(gram, columns, model->output_column());
  const double floor =
      NoiseFloor(grams, columns, model->output_column(), theta, window, model->WalkingParameters());
  return std::sqrt(MeanSquaredError(flow, theta)) / floor;
}

TEST(NoiseFloor, IsTheErrorThatTheRigsNoiseCausesWhateverTheSpan) {
  const auto logs = Logs(SensorNoise{}, 6);
  for (const double span : {0.2, 0.4, 0.8, 1.6}) EXPECT_NEAR(ErrorOverFloor(logs, span), 1.0, 0.04) << span;
}

TEST(NoiseFloor, CountsNoiseOfThePressureThatIsIntegratedAsTheFlowSeesIt) {
  SensorNoise noise;
  noise.z = 0;
  const auto logs = Logs(noise, 6);
  for (const double span : {0.4, 1.6}) EXPECT_NEAR(ErrorOverFloor(logs, span), 1.0, 0.08) << span;
}

TEST(NoiseFloor, CountsNoiseOfTheSpoolThatIsIntegratedAsTheFlowSeesIt) {
  SensorNoise noise;
  noise.z = noise.p_A = 0;
  noise.y_v = 3e-3;
  const auto logs = Logs(noise, 6);
  for (const double span : {0.4, 1.6}) EXPECT_NEAR(ErrorOverFloor(logs, span), 1.0, 0.08) << span;
}

}  // namespace
}  // namespace hydroscope
