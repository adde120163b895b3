#include "page/stroke_pictures.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/units.h"
#include "diagnosis/free_run.h"
#include "models/output_unit.h"

namespace hydroscope {
namespace {

nlohmann::json ScaledJson(const std::vector<double>& values, double factor) {
  nlohmann::json out = nlohmann::json::array();
  for (const double value : values) out.push_back(value * factor);
  return out;
}

nlohmann::json SignalsJson(const Residuals& residuals, const StrokeResiduals& stroke) {
  nlohmann::json out = nlohmann::json::array();
  for (std::size_t s = 0; s < residuals.signals.size(); ++s) {
    const ResidualSignal& signal = residuals.signals[s];
    nlohmann::json values = nlohmann::json::array();
    for (int w = 0; w < stroke.windows(); ++w)
      values.push_back(stroke.signal(static_cast<int>(s), w) * signal.factor + signal.offset);
    out.push_back({{"name", signal.name}, {"unit", signal.unit}, {"values", values}});
  }
  return out;
}

nlohmann::json FreeRunJson(const FreeRunStroke& run, double step) {
  const DisplayUnit unit =
      DisplayUnitFor("Pa");  // the only channel that a balance runs by itself is a pressure
  return {{"unit", unit.name},
          {"step", step},
          {"measured", ScaledJson(run.measured, unit.factor)},
          {"simulated", ScaledJson(run.simulated, unit.factor)}};
}

}  // namespace

nlohmann::json StrokePicturesJson(const CompareResult& result) {
  const DisplayUnit unit = OutputUnit(result.log.model.get());
  const double step = result.log.window.block * result.log.window.period;
  const auto runs = FreeRun(*result.model.structure, result.log.stretches, result.log.window,
                            ColumnWeights(*result.model.structure, result.model.fit));
  nlohmann::json out = nlohmann::json::array();
  for (std::size_t s = 0; s < result.residuals.strokes.size(); ++s) {
    const StrokeResiduals& stroke = result.residuals.strokes[s];
    std::vector<double> noise;
    for (const double variance : stroke.noise_variance) noise.push_back(std::sqrt(variance));
    out.push_back({{"stroke", result.per_stroke[s].stroke},
                   {"begin", result.per_stroke[s].begin},
                   {"step", step},
                   {"unit", unit.name},
                   {"measured", ScaledJson(stroke.measured, unit.factor)},
                   {"modelled", ScaledJson(stroke.modelled, unit.factor)},
                   {"noise", ScaledJson(noise, unit.factor)},
                   {"signals", SignalsJson(result.residuals, stroke)},
                   {"free_run", runs ? FreeRunJson((*runs)[s], step) : nlohmann::json()}});
  }
  return out;
}

}  // namespace hydroscope
