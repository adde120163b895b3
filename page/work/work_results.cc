#include "page/work/work_results.h"

#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>

#include "core/effect_units.h"
#include "core/units.h"
#include "models/machine_kind.h"
#include "page/work/loop_results.h"
#include "page/work/stroke_pictures.h"
#include "workbench/check_output.h"
#include "workbench/compare_output.h"
#include "workbench/explain/explain_output.h"
#include "workbench/fit_output.h"
#include "workbench/frequency_response/loop_change.h"
#include "workbench/model/model_edit.h"
#include "workbench/model/model_history_output.h"
#include "workbench/model/model_output.h"
#include "workbench/states/states_output.h"

namespace hydroscope {
namespace {

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
