#include "diagnosis/states/state_residuals.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/units.h"
#include "models/output_unit.h"

namespace hydroscope {
namespace {

constexpr int kMostReadings = 20'000;
constexpr std::size_t kFewestCycles = 3;

/// A signal or a state, as shown.
ResidualSignal Shown(const Machine& machine, const std::string& name) {
  const DisplayUnit unit = ShownUnit(machine, name);
  return {name, -1, unit.factor, unit.offset, std::string(unit.name)};
}

}  // namespace

std::vector<ResidualSignal> RunSignals(const StateFit& fit) {
  const StateModel& model = *fit.model;
  const Machine& machine = model.machine;
  std::vector<ResidualSignal> out;
  const auto add_signal = [&](int signal) {
    out.push_back(Shown(machine, machine.signals[static_cast<std::size_t>(signal)].name));
  };
  for (const int input : model.inputs) add_signal(input);
  for (std::size_t i = 0; i < machine.states.states.size(); ++i)
    if (model.measured_by[i] < 0) out.push_back(Shown(machine, machine.states.states[i].name));
  for (const int output : model.outputs) add_signal(output);
  if (fit.runs.size() >= kFewestCycles) out.push_back({"phase", -1, 100, 0, "%"});
  return out;
}

std::vector<double> RunSignalsAt(const StateFit& fit, std::span<const Episode> episodes, std::size_t episode,
                                 int row) {
  const StateModel& model = *fit.model;
  const StateRun& run = fit.runs[episode];
  std::vector<double> out;
  for (const int input : model.inputs) out.push_back(episodes[episode].signal(row, input));
  for (int i = 0; i < model.states(); ++i)
    if (model.measured_by[static_cast<std::size_t>(i)] < 0) out.push_back(run.states(row, i));
  for (int j = 0; j < model.output.rows; ++j) out.push_back(run.outputs(row, j));
  if (fit.runs.size() >= kFewestCycles) out.push_back((row + 0.5) / episodes[episode].rows());
  return out;
}

Residuals ResidualsOf(const StateFit& fit, std::span<const Episode> episodes, int output,
                      const StateRemainder& left) {
  int readings = 0;
  for (const StatePiece& piece : fit.pieces) readings += piece.readings;
  const double noise_share = left.structured ? std::min(1.0, left.energy) : 1.0;
  const double noise_variance = fit.noise[output] * fit.noise[output] * noise_share;
  const int every = 1 + readings / fit.model->output.rows / kMostReadings;
  Residuals out;
  out.signals = RunSignals(fit);
  const auto count = static_cast<Eigen::Index>(out.signals.size());
  for (const StatePiece& piece : fit.pieces) {
    const auto e = static_cast<std::size_t>(piece.episode);
    StrokeResiduals stroke;
    std::vector<double> signals;
    for (int row = piece.first, seen = 0; row < piece.last; ++row) {
      const double error = fit.residuals[e](row, output), modelled = fit.runs[e].outputs(row, output);
      if (!std::isfinite(error) || !std::isfinite(modelled) || seen++ % every != 0) continue;
      stroke.modelled.push_back(modelled);
      stroke.measured.push_back(modelled + error);
      const std::vector<double> here = RunSignalsAt(fit, episodes, e, row);
      signals.insert(signals.end(), here.begin(), here.end());
    }
    stroke.noise_variance.assign(stroke.measured.size(), noise_variance);
    stroke.signal = Eigen::Map<const Eigen::MatrixXd>(signals.data(), count, stroke.windows());
    out.strokes.push_back(std::move(stroke));
  }
  return out;
}

}  // namespace hydroscope
