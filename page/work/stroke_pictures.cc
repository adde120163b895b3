#include "page/work/stroke_pictures.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/units.h"
#include "diagnosis/free_run.h"
#include "diagnosis/states/state_residuals.h"
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

nlohmann::json FreeRunJson(const FreeRunStroke& run, const FreeRunChannel& channel, double step) {
  const DisplayUnit unit = DisplayUnitFor(channel.si);
  return {{"unit", unit.name},
          {"step", step},
          {"measured", ScaledJson(run.measured, unit.factor)},
          {"simulated", ScaledJson(run.simulated, unit.factor)}};
}

}  // namespace

nlohmann::json StrokePicturesJson(const CompareResult& result) {
  const DisplayUnit unit = OutputUnit(result.log.machine);
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
                   {"free_run", runs ? FreeRunJson((*runs)[s], *result.model.structure->free_run, step)
                                     : nlohmann::json()}});
  }
  return out;
}

namespace {

constexpr int kMostRows = 3000;  ///< of an episode's picture

/// Of every `step`-th row.
nlohmann::json RunSignalsJson(const StatesFit& fit, std::size_t episode, int step) {
  const std::vector<ResidualSignal> signals = RunSignals(fit.fit);
  nlohmann::json out = nlohmann::json::array();
  for (const ResidualSignal& signal : signals)
    out.push_back({{"name", signal.name}, {"unit", signal.unit}, {"values", nlohmann::json::array()}});
  for (int row = 0; row < fit.log.episodes[episode].rows(); row += step) {
    const std::vector<double> values = RunSignalsAt(fit.fit, fit.log.episodes, episode, row);
    for (std::size_t s = 0; s < signals.size(); ++s)
      out[s]["values"].push_back(values[s] * signals[s].factor + signals[s].offset);
  }
  return out;
}

nlohmann::json EpisodeJson(const StatesFit& fit, std::size_t index) {
  const StateModel& model = *fit.fit.model;
  const Episode& episode = fit.log.episodes[index];
  const StateRun& run = fit.fit.runs[index];
  const int step = episode.rows() / kMostRows + 1;
  // Of each group of rows one that was measured, if there is any: outputs may have readings now and then only.
  const auto course = [&](const DisplayUnit& unit, int signal, auto value) {
    nlohmann::json out = nlohmann::json::array();
    for (int begin = 0; begin < episode.rows(); begin += step) {
      int row = begin;
      for (int k = begin; k < std::min(begin + step, episode.rows()); ++k)
        if (std::isfinite(episode.signal(k, signal))) row = k;
      out.push_back(value(row) * unit.factor + unit.offset);
    }
    return out;
  };
  nlohmann::json outputs = nlohmann::json::array();
  for (int j = 0; j < model.output.rows; ++j) {
    const std::string& name = model.machine.states.outputs[static_cast<std::size_t>(j)].signal;
    const DisplayUnit unit = ShownUnit(model.machine, name);
    const int signal = model.outputs[static_cast<std::size_t>(j)];
    outputs.push_back(
        {{"name", name},
         {"unit", unit.name},
         {"noise", fit.one_step[static_cast<std::size_t>(j)] * unit.factor},
         {"measured", course(unit, signal, [&](int row) { return episode.signal(row, signal); })},
         {"modelled", course(unit, signal, [&](int row) { return run.outputs(row, j); })}});
  }
  const double seconds = episode.time.back() - episode.time.front();
  return {{"begin", episode.time.front()},
          {"step", episode.rows() > 1 ? seconds / (episode.rows() - 1) * step : 0},
          {"unit", outputs.front()["unit"]},
          {"measured", outputs.front()["measured"]},
          {"modelled", outputs.front()["modelled"]},
          {"noise", nlohmann::json::array()},
          {"signals", RunSignalsJson(fit, index, step)},
          {"free_run", nullptr},
          {"outputs", std::move(outputs)}};
}

}  // namespace

nlohmann::json EpisodePicturesJson(const StatesFit& fit) {
  nlohmann::json out = nlohmann::json::array();
  for (std::size_t e = 0; e < fit.log.episodes.size(); ++e) {
    if (fit.log.episodes[e].rows() == 0 || fit.fit.runs.size() <= e) continue;
    out.push_back(EpisodeJson(fit, e));
    out.back()["stroke"] = e;
  }
  return out;
}

}  // namespace hydroscope
