#include "page/work/work_results.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numbers>
#include <set>

#include "core/constants.h"
#include "core/effect_units.h"
#include "core/units.h"
#include "diagnosis/free_run.h"
#include "diagnosis/states/state_residuals.h"
#include "models/closed_loop.h"
#include "models/machine_kind.h"
#include "models/output_unit.h"
#include "workbench/check_output.h"
#include "workbench/compare_log.h"
#include "workbench/compare_output.h"
#include "workbench/explain/explain_output.h"
#include "workbench/fit_output.h"
#include "workbench/frequency_response/loop_change.h"
#include "workbench/frequency_response/loop_output.h"
#include "workbench/model/model_edit.h"
#include "workbench/model/model_history_output.h"
#include "workbench/model/model_output.h"
#include "workbench/states/states_log.h"
#include "workbench/states/states_output.h"

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

nlohmann::json FreeRunJson(const FreeRunStroke& run, const ModelStructure& model, double step) {
  const DisplayUnit unit = DisplayUnitFor(model.free_run->si);
  return {{"signal", model.channel_names[static_cast<std::size_t>(model.free_run->channel)]},
          {"unit", unit.name},
          {"step", step},
          {"measured", ScaledJson(run.measured, unit.factor)},
          {"simulated", ScaledJson(run.simulated, unit.factor)}};
}

/// Measured beside modelled of every stroke of a comparison, an array in the order of CompareResult::per_stroke: `stroke`,
/// `begin` and `step` (s), `unit`, `measured`, `modelled`, `noise` (standard deviation that sensor noise gives their
/// difference), `signals` (`name`, `unit`, `values`: means over each window), and `free_run` (`signal`, `unit`, `step`, `measured`,
/// `simulated`) or null.
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
    out.push_back(
        {{"stroke", result.per_stroke[s].stroke},
         {"begin", result.per_stroke[s].begin},
         {"step", step},
         {"unit", unit.name},
         {"measured", ScaledJson(stroke.measured, unit.factor)},
         {"modelled", ScaledJson(stroke.modelled, unit.factor)},
         {"noise", ScaledJson(noise, unit.factor)},
         {"signals", SignalsJson(result.residuals, stroke)},
         {"free_run", runs ? FreeRunJson((*runs)[s], *result.model.structure, step) : nlohmann::json()}});
  }
  return out;
}

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

/// The same of a machine with states, whose model runs by itself through each episode: `modelled` is that run. Of long episodes
/// every so many rows. `noise` is empty; `outputs` (`name`, `unit`, `measured`, `modelled`, `noise`: what stays of the error where
/// past errors may be used, so at most this is noise of the sensor) has all outputs, of which the first is the picture's own.
nlohmann::json EpisodePicturesJson(const StatesFit& fit) {
  nlohmann::json out = nlohmann::json::array();
  for (std::size_t e = 0; e < fit.log.episodes.size(); ++e) {
    if (fit.log.episodes[e].rows() == 0 || fit.fit.runs.size() <= e) continue;
    out.push_back(EpisodeJson(fit, e));
    out.back()["stroke"] = e;
  }
  return out;
}

constexpr std::size_t kMostPoints = 400;
const double kDecibelsOfE = 20 / std::numbers::ln10;

std::string FileName(const std::string& path) { return std::filesystem::path(path).filename(); }

/// Gain and phase of a model at the points.
void AddCurve(const LoopLog& measured, const std::vector<const FrequencyPoint*>& points,
              const std::vector<double>& parameters, const std::string& of, nlohmann::json& response) {
  for (const FrequencyPoint* p : points) {
    const double gain = std::abs(measured.model.Response(p->frequency, parameters));
    response[of + "_gain"].push_back(kDecibelsOfE * std::log(gain));
    response[of + "_phase"].push_back(PhaseBeside(measured.model, parameters, p->frequency, *p) * kDegrees);
  }
}

nlohmann::json ResponseJson(const LoopLog& measured, const Result<LoopState>& before) {
  const std::vector<const FrequencyPoint*> points = UsedPoints(measured.response, kMostPoints);
  nlohmann::json json = {{"f_hz", nlohmann::json::array()}};
  for (const FrequencyPoint* p : points) {
    json["f_hz"].push_back(p->frequency);
    json["gain"].push_back(kDecibelsOfE * std::log(p->gain()));
    json["gain_half"].push_back(kDecibelsOfE * kNormal95 * p->GainStd() / p->gain());
    json["phase"].push_back(p->phase * kDegrees);
    json["phase_half"].push_back(kNormal95 * p->PhaseStd() * kDegrees);
  }
  if (measured.response.fit) AddCurve(measured, points, measured.response.fit->parameters, "model", json);
  if (before) AddCurve(measured, points, before->parameters, "before", json);
  return json;
}

/// Work on a log of a machine in closed loop; the log held out is the one before, without one the references of the machine file
/// are. kExplain: LoopChangeJson. Otherwise LoopJson, its points as the lists of `response`: `f_hz`, and of gain (dB) and phase
/// (degrees) what was measured with the half of its 95 % interval, what the model gives and what the one before gave
/// (`before_gain`, `before_phase`; null where nothing is known of before). Both with `text`, what the command prints.
Result<nlohmann::json> WorkOutLoop(WorkRequest::Kind kind, const WorkInput& input) {
  if (kind == WorkRequest::Kind::kExplain) {
    auto changed = TRY(ExplainLoopLog(input.Newest(), input.hold_out, input.machine_file));
    changed.since = FileName(changed.since);
    changed.after.name = FileName(changed.after.name);
    nlohmann::json json = LoopChangeJson(changed);
    json["text"] = LoopChangeText(changed);
    return json;
  }
  const auto machine = TRY(LoadMachine(input.machine_file));
  auto measured = TRY(MeasureLoopLog(input.Newest(), machine));
  measured.name = FileName(measured.name);
  nlohmann::json json = LoopJson(measured, machine);
  json.erase("points");
  json["response"] = ResponseJson(measured, LoopStateBefore(input.hold_out, machine));
  json["text"] = LoopText(measured, machine);
  return json;
}

nlohmann::json WithText(nlohmann::json json, std::string text) {
  json["text"] = std::move(text);
  return json;
}

/// The logs that models are fitted to; `explain` knows no others.
std::vector<std::string> FittedLogs(const WorkInput& input) {
  std::vector<std::string> fitted = input.logs;
  std::erase(fitted, input.hold_out);
  return fitted;
}

/// A machine described by states.
Result<nlohmann::json> WorkOutStates(WorkRequest::Kind kind, const WorkInput& input,
                                     StrokeFindings& strokes) {
  if (kind == WorkRequest::Kind::kExplain) {
    const auto explained = TRY(ExplainStatesLogs(FittedLogs(input), input.machine_file));
    return WithText(ExplainJson(explained), ExplainText(explained));
  }
  if (kind == WorkRequest::Kind::kFit) {
    const auto fit = TRY(FitStatesLogs(input.logs, input.machine_file, input.hold_out));
    return WithText(FitJson(fit), FitText(fit));
  }
  const auto fit = TRY(CompareStatesLogs(input.logs, input.machine_file, input.hold_out));
  strokes.pictures = EpisodePicturesJson(fit);
  strokes.errors.Take(fit);
  return WithText(CompareJson(fit), CompareText(fit));
}

}  // namespace

std::string WorkInput::Newest() const {
  std::string newest;
  for (const std::string& log : logs)
    if (log != hold_out) newest = log;
  return newest;
}

Result<nlohmann::json> WorkOut(WorkRequest::Kind kind, const WorkInput& input, StrokeFindings& strokes) {
  if (kind == WorkRequest::Kind::kCheck) {
    const auto check = TRY(CheckLog(input.logs.front(), input.machine_file));
    return WithText(CheckJson(check), CheckText(check, std::filesystem::path(input.machine_file).filename()));
  }
  if (IsClosedLoop(input.machine_file)) return WorkOutLoop(kind, input);
  if (HasStates(input.machine_file)) return WorkOutStates(kind, input, strokes);
  if (kind == WorkRequest::Kind::kFit) {
    const auto fit = TRY(FitLogs(input.logs, input.machine_file, input.hold_out));
    return WithText(FitJson(fit), FitText(fit));
  }
  if (kind == WorkRequest::Kind::kExplain) {
    ExplainOptions options;
    options.measured = input.measured;
    const auto explained = TRY(ExplainLogs(FittedLogs(input), input.machine_file, options));
    strokes.errors.Take(explained);
    return WithText(ExplainJson(explained), ExplainText(explained));
  }
  const auto compared = TRY(CompareLogs(input.logs, input.machine_file, input.hold_out));
  strokes.pictures = StrokePicturesJson(compared);
  strokes.errors.Take(compared);
  strokes.term = TermStroke::Of(compared, FittedLogs(input));
  return WithText(CompareJson(compared), CompareText(compared));
}

Result<nlohmann::json> TryChange(const std::string& effect, MakeNext make_next, const WorkInput& input,
                                 const std::string& out) {
  std::error_code none_there;
  std::filesystem::remove(out, none_there);
  ModelChange change;
  change.effect = effect;
  change.machine = input.machine_file;
  change.out = out;
  change.logs = input.logs;
  change.hold_out = input.hold_out;
  const auto changed = TRY(ChangeModel(change, make_next));
  const nlohmann::json versions = ModelHistoryJson(changed.machine)["versions"];
  const std::size_t count = versions.size();
  return nlohmann::json{
      {"effect", effect},
      {"error", changed.error},
      {"held_out", changed.held_out},
      {"warnings", InEnglish(changed.warnings)},
      {"german", {{"warnings", InGerman(changed.warnings)}}},
      {"parameters_before", count > 1 ? versions[count - 2]["parameters"] : nlohmann::json()},
      {"parameters_after", count > 0 ? versions[count - 1]["parameters"] : nlohmann::json()}};
}

nlohmann::json UnitsJson(const Machine& machine) {
  std::set<std::string> plain{"s", std::string(OutputSi(machine))}, of_effects;
  const MachineKind& kind = KindOf(machine);
  for (const auto* inputs : {&kind.signals, &kind.geometry})
    for (const MachineInput& input : *inputs) plain.emplace(input.si);
  for (const MachineParameter& parameter : kind.parameters) plain.emplace(parameter.si);
  for (const ParameterSpec& parameter : machine.states.parameters) plain.insert(parameter.unit);
  for (const SignalSpec& signal : machine.signals)
    if (const auto unit = FindUnit(signal.unit)) plain.emplace(unit->si);
  for (const TermSpec& term : machine.balance.terms) plain.insert(term.unit);
  for (const TermSpec& term : machine.balance.derived) plain.insert(term.unit);
  const nlohmann::json library = EffectsJson(&machine);
  for (const nlohmann::json& effect : library["effects"]) {
    of_effects.insert(effect["unit"].get<std::string>());
    for (const nlohmann::json& nonlinear : effect["nonlinear"])
      of_effects.insert(nonlinear["unit"].get<std::string>());
  }
  nlohmann::json units = nlohmann::json::object();
  for (const std::string& si : of_effects) {
    const EffectUnit unit = EffectUnitFor(si);
    units[si] = {{"factor", unit.factor}, {"offset", 0}, {"name", unit.name}};
  }
  for (const std::string& si : plain) {
    const DisplayUnit unit = DisplayUnitFor(si);
    units[si] = {{"factor", unit.factor}, {"offset", unit.offset}, {"name", unit.name}};
  }
  return units;
}

}  // namespace hydroscope
