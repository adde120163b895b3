#pragma once

#include <memory>
#include <vector>

#include "diagnosis/extended_fit.h"
#include "diagnosis/sample_grams.h"
#include "estimation/stroke_segmenter.h"
#include "models/machine.h"
#include "simulator/die_cushion/press.h"

namespace hydroscope {

/// For tests: a simulated log of the press as the estimation cuts it into strokes, without the pipeline above.
struct SimulatedStrokes {
  std::shared_ptr<const ModelStructure> model;
  std::vector<StrokeStretches> strokes;
  WindowSamples window;

  ExtendedFit Fit(std::span<const EffectChoice> choices = {}) const {
    return StrokeSet(model, GramsOf(model, strokes, window), window).Fit(choices);
  }
};

inline Machine MachineOf(const PressOptions& options) {
  Machine machine;
  machine.name = "simulated";
  for (const char* name : {"p_A", "z", "y_v", "p_B", "p_0", "T_oil"}) {
    SignalSpec signal;
    signal.name = signal.column = name;
    machine.signals.push_back(signal);
  }
  machine.geometry["A_A"] = {options.machine.A_A, 0};
  machine.geometry["dp_nom"] = {options.machine.dp_nom, 0};
  machine.geometry["p_t"] = {options.machine.p_tank, 0};
  machine.gate.bounds = {{"y_v", false, 0.04, std::nullopt}, {"z", true, std::nullopt, -0.004}};
  return machine;
}

inline SimulatedStrokes StrokesOfPress(const PressOptions& options) {
  const SimulatedLog log = SimulatePress(options);
  const Machine machine = MachineOf(options);
  SimulatedStrokes out;
  out.model = *BuildModel(machine);
  out.window = WindowSamples::From(WindowSpec{}, options.sample_period);
  SampleBlock rows;
  rows.Resize(machine.signals.size(), log.rows());
  rows.time = log.t;
  rows.signal = {log.p_A, log.z, log.y_v, log.p_B, log.p_0, log.T_oil};
  StrokeStretches stretches;
  StrokeSegmenter segmenter(machine, out.model, out.window,
                            {[&](Stretch& s, double) { stretches.push_back(s); },
                             [&](const StrokeSummary&) {
                               out.strokes.push_back(std::move(stretches));
                               stretches.clear();
                             },
                             [&] { stretches.clear(); }});
  segmenter.Process(rows);
  segmenter.Finish();
  return out;
}

}  // namespace hydroscope
