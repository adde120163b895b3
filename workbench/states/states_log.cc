#include "workbench/states/states_log.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/shell_word.h"
#include "core/told_error.h"
#include "diagnosis/states/explain_states.h"
#include "diagnosis/states/held_out_run.h"
#include "diagnosis/states/other_causes/initial_values.h"
#include "diagnosis/states/spread_pieces.h"
#include "host/text_sink.h"
#include "host/work_line.h"
#include "models/machine_kind.h"
#include "models/output_unit.h"
#include "workbench/held_out_log.h"
#include "workbench/model/model_record.h"
#include "workbench/states/measured_otherwise.h"

namespace hydroscope {
namespace {

constexpr Wording kRecord = {"the record", "die Aufnahme"};

/// Several outputs as a share of their variation.
double Overall(const StateFit& fit, const Eigen::VectorXd& rms) {
  if (rms.size() == 1) return rms[0];
  return std::sqrt(rms.cwiseQuotient(fit.scale).squaredNorm() / static_cast<double>(rms.size()));
}

/// What is left is no white noise.
bool Coloured(const StatesError& error, const StateRemainder& left) {
  return left.structured || error.coloured();
}

/// Judged by what `explain` judges by, so that both say the same: of means over revolutions by a fit over short runs, in which a
/// disturbance that a free run carries along for long counts once.
StateRemainder JudgedRemainder(const StateFit& fit, const std::vector<Episode>& episodes,
                               const StateFitOptions& options) {
  const bool means = std::ranges::any_of(episodes, [](const Episode& e) { return e.mean_rows > 1; });
  const std::vector<Episode> runs =
      means ? ShortRuns(episodes, ExplainStatesOptions{}.means.readings) : std::vector<Episode>();
  if (!runs.empty()) {
    const StateStart start{fit.parameters, {}};
    const StateFit over_runs = RefitStates(fit.model, runs, std::span(&start, 1), fit.noise, options);
    if (over_runs.solved()) return RemainderOf(over_runs, runs);
  }
  return RemainderOf(fit, episodes);
}

/// Initial states that the machine file gives outside of the limits it gives: they begin at the limit.
std::vector<Told> InitialWarnings(const StateFit& fit, const std::vector<Episode>& episodes) {
  const StateModel& model = *fit.model;
  StateSimulator simulator(fit.model);
  simulator.SetParameters(fit.parameters);
  std::vector<double> registers = model.initial.values.Registers();
  std::vector<int> outside(static_cast<std::size_t>(model.states()), 0);
  for (const Episode& episode : episodes) {
    const auto signals = static_cast<Eigen::Index>(model.machine.signals.size());
    for (Eigen::Index s = 0; s < std::min(signals, episode.signal.cols()); ++s)
      registers[s] = episode.Reading(0, static_cast<int>(s));
    std::ranges::copy(fit.parameters, registers.begin() + signals);
    model.initial.values.RunFixed(registers.data());
    model.initial.values.Run(registers.data());
    for (int i = 0; i < model.states(); ++i) {
      const auto at = static_cast<std::size_t>(i);
      const double x = registers[model.initial.values.output(at)];
      const bool given = model.machine.states.states[at].initial != "estimate";
      outside[at] += given && (x < simulator.limits()[i] || x > simulator.limits()[model.states() + i]);
    }
  }
  std::vector<Told> warnings;
  for (int i = 0; i < model.states(); ++i)
    if (const int count = outside[i]; count > 0) {
      const StateSpec& state = model.machine.states.states[i];
      warnings.push_back(Tell(
          "initial = \"{}\" of {} is outside of its limits in {} of {} episodes, which begin at the limit; check unit, "
          "zero and limits",
          "initial = \"{}\" von {} liegt in {} von {} Episoden außerhalb seiner Grenzen, sie beginnen an der Grenze; "
          "Einheit, "
          "Nullpunkt und Grenzen prüfen",
          state.initial, state.name, count, episodes.size()));
    }
  return warnings;
}

}  // namespace

bool HasStates(const std::string& machine_file) {
  if (machine_file.empty()) return false;
  const auto machine = LoadMachine(machine_file);
  return machine && KindOf(*machine).has_states;
}

std::vector<Estimate> EstimatesOf(const StateFit& fit) {
  std::vector<Estimate> out;
  for (int p = 0; p < fit.model->parameter_count(); ++p) {
    const StateParameter& parameter = fit.model->parameters[p];
    Estimate e;
    e.parameter = parameter.name;
    e.value = fit.parameters[p];
    e.std = std::sqrt(std::max(0.0, fit.covariance(p, p)));
    e.unit = parameter.spec.unit.empty() ? "1" : parameter.spec.unit;
    e.reason = EstimateReason::kUpdated;
    e.excitation = 1;
    for (const UnseenDirection& unseen : fit.unseen)
      for (const auto& [name, share] : unseen.parts) {
        if (name != parameter.name) continue;
        e.reason = unseen.parts.size() == 1 ? EstimateReason::kNotExcited : EstimateReason::kConfounded;
        e.excitation = 0;
      }
    if (fit.at_limit[p] && e.reason == EstimateReason::kUpdated) e.reason = EstimateReason::kOutsidePhysics;
    out.push_back(std::move(e));
  }
  return out;
}

StatesError ErrorOf(const StateFit& fit, const StateRemainder& left) {
  StatesError out;
  out.unit = OutputUnit(fit.model->machine);
  out.of_variation = fit.noise.size() > 1;
  out.rms = Overall(fit, fit.noise) * out.unit.factor;
  out.rms_holdout = ErrorLeftOut(fit) * out.unit.factor;
  out.noise_floor = out.rms * (left.structured ? std::sqrt(left.energy) : 1.0);
  Eigen::VectorXd steps(fit.noise.size());
  for (int j = 0; j < steps.size(); ++j) steps[j] = OneStepError(fit, j);
  out.one_step = Overall(fit, steps) * out.unit.factor;
  return out;
}

Result<StatesFit> FitEpisodes(EpisodeLog log, const WorkListener& tells) {
  LinearStart start = StartOf(log.machine, log.episodes);
  if (tells)
    start.options.tells_start = [&](int begun, std::size_t starts) {
      tells(fmt::format("fits, start {} of at most {}", begun, starts));
    };
  const auto model = TRY(BuildStateModel(start.machine, log.machine.added_effects));
  StatesFit out;
  out.linear = std::move(start.fit);
  out.fit = FitStates(model, log.episodes, start.options);
  if (!out.fit.solved())
    return BadInput(Tell("machine '{}': {}", "Maschine '{}': {}", log.machine.name, out.fit.failed));
  out.left = JudgedRemainder(out.fit, log.episodes, start.options);
  out.error = ErrorOf(out.fit, out.left);
  out.dynamics = FindMissingDynamics(out.fit, out.left, log.episodes);
  const bool in_doubt = out.left.structured || out.slow();
  if (tells) tells("looks at how it is sampled");
  MeasuredOtherwise otherwise;
  if (in_doubt || out.dynamics || out.noise_alone())
    otherwise = FindMeasuredOtherwise(out.fit, log.episodes,
                                      out.noise_alone() ? LeftBySampling::kNoise : LeftBySampling::kDoubt);
  if (const TakenOtherwise taken = TakeOtherwise(otherwise, log); taken != TakenOtherwise::kNothing) {
    auto with_it = FitEpisodes(std::move(log), tells);
    if (with_it && taken == TakenOtherwise::kZeros) with_it->zeros = otherwise.zeros;
    return with_it;
  }
  out.other_sampling = otherwise.sampling;
  if (in_doubt) {
    out.doubted_limit = FindDoubtedLimit(out.fit, log.episodes);
    out.missing_limit = FindMissingLimit(out.fit, log.episodes);
  }
  out.drift = FindParameterDrift(out.fit, out.left);
  if (Coloured(out.error, out.left))
    if (const auto other = FindOtherBeginning(out.fit, log.episodes))
      log.warnings.push_back(OtherBeginningText(*other, Told(kRecord)));
  if (out.slow() && !out.drift && !out.dynamics) {
    StateFit prediction = PredictStates(out.fit, log.episodes);
    if (prediction.solved() &&
        Overall(out.fit, prediction.noise) * out.error.unit.factor < kSlowError * out.error.rms)
      out.prediction = std::move(prediction);
  }
  out.told_together = FindToldTogether(out.fit, log.episodes);
  out.parameters = EstimatesOf(out.prediction ? *out.prediction : out.fit);
  for (int j = 0; j < out.fit.noise.size(); ++j) out.one_step.push_back(OneStepError(out.fit, j));
  for (Told& warning : InitialWarnings(out.fit, log.episodes)) log.warnings.push_back(std::move(warning));
  out.log = std::move(log);
  return out;
}

Result<StatesFit> FitStatesLogs(const std::vector<std::string>& logs, const std::string& machine_file,
                                const std::string& hold_out) {
  const auto machine = TRY(LoadMachine(machine_file));
  const auto chosen = TRY(ChooseLogs(logs, hold_out));
  auto log = TRY(ReadEpisodes(chosen.fitted, machine));
  WorkLine line("fit");
  auto out = FitEpisodes(std::move(log), line.Listener());
  if (!out || chosen.held_out.empty()) return out;
  const auto other = TRY(ReadEpisodes({chosen.held_out}, machine));
  const StateFit& fitted = out->prediction ? *out->prediction : out->fit;
  const StateFit followed = FollowStates(fitted.model, other.episodes, fitted.parameters, out->fit.noise);
  if (!followed.solved()) return BadInput(Tell("{}: {}", "{}: {}", chosen.held_out, followed.failed));
  out->held_out =
      Overall(out->fit, RmsOf(followed.residuals, followed.model->output.rows)) * out->error.unit.factor;
  const HeldOutRun run = LookAtHeldOut(out->fit, out->log.episodes, followed, other.episodes);
  for (Told& text : HeldOutTexts(run, *fitted.model, chosen.held_out))
    out->log.warnings.push_back(std::move(text));
  if (const auto begins = FindOtherBeginningHeldOut(fitted, other.episodes))
    out->log.warnings.push_back(OtherBeginningText(*begins, Told(chosen.held_out)));
  out->held_out_log = chosen.held_out;
  out->held_out_episodes = static_cast<int>(other.episodes.size());
  return out;
}

Result<StatesFit> CompareStatesLogs(const std::vector<std::string>& logs, const std::string& machine_file,
                                    const std::string& hold_out) {
  auto out = FitStatesLogs(logs, machine_file, hold_out);
  if (out) out->located = LocateErrors(out->fit, out->log.episodes, out->left);
  return out;
}

Result<StatesExplained> ExplainStatesLogs(const std::vector<std::string>& logs,
                                          const std::string& machine_file) {
  const auto machine = TRY(LoadMachine(machine_file));
  auto log = TRY(ReadEpisodes(logs, machine));
  WorkLine line("explain");
  auto out = ExplainReadEpisodes(std::move(log), line.Listener());
  if (out) out->target = "--machine " + ShellWord(machine_file);
  return out;
}

Result<StatesExplained> ExplainReadEpisodes(EpisodeLog log, const WorkListener& tells) {
  StatesExplained out;
  const LinearStart start = StartOf(log.machine, log.episodes);
  ExplainStatesOptions options;
  options.fit = start.options;
  options.threads = 0;
  options.tells = tells;
  out.explanation = ExplainStates(start.machine, log.episodes, options);
  out.log = std::move(log);
  const StatesExplanation& x = out.explanation;
  if (!x.base.fit.solved())
    return BadInput(Tell("machine '{}': {}", "Maschine '{}': {}", out.log.machine.name, x.base.fit.failed));
  const std::span<const Episode> fitted =
      x.runs.empty() ? std::span<const Episode>(out.log.episodes) : std::span<const Episode>(x.runs);
  if (tells) tells("looks at how it is sampled");
  const MeasuredOtherwise otherwise = FindMeasuredOtherwise(x, fitted);
  if (const TakenOtherwise taken = TakeOtherwise(otherwise, out.log); taken != TakenOtherwise::kNothing) {
    auto with_it = ExplainReadEpisodes(std::move(out.log), tells);
    if (!with_it || taken != TakenOtherwise::kZeros) return with_it;
    with_it->zeros = otherwise.zeros;
    // The constant may be a law as well: no all-clear.
    if (with_it->explanation.verdict == Verdict::kAdequate) with_it->explanation.LeaveUnknown({});
    return with_it;
  }
  for (Told& warning : InitialWarnings(x.base.fit, out.log.episodes))
    out.log.warnings.push_back(std::move(warning));
  if (otherwise.sampling) {
    out.log.warnings.push_back(OtherSamplingText(*otherwise.sampling));
    out.explanation.LeaveDoubt();
  }
  out.experiment = ProposeStateExperiment(x, out.log.episodes);
  out.base = ErrorOf(x.base.fit, x.base_left);
  out.final = ErrorOf(x.final.fit, x.final_left);
  if (x.runs.empty() && Coloured(out.final, x.final_left))  // runs that were cut begin anywhere
    if (const auto other = FindOtherBeginning(x.final.fit, fitted))
      out.log.warnings.push_back(OtherBeginningText(*other, Told(kRecord)));
  out.located = LocateErrors(x.base.fit, fitted, x.base_left);
  if (x.verdict == Verdict::kUnknown && x.final_left.structured)
    if (const auto law = FindMissingLaw(x.final.fit, fitted, x.final_left.about))
      out.missing = Shown(*law, *x.final.fit.model);
  out.base_parameters = EstimatesOf(x.base.fit);
  out.final_parameters = EstimatesOf(x.final.fit);
  return out;
}

ModelRecord RecordOf(const StatesFit& fit, const std::string& source) {
  const Machine& machine = fit.fit.model->machine;
  ModelRecord record;
  record.version = machine.model_version;
  record.name = ModelName(machine);
  record.effects = fit.fit.model->effects;
  record.source = source;
  record.strokes = static_cast<int>(fit.log.episodes.size());
  record.rms_holdout = fit.error.rms_holdout / fit.error.unit.factor;
  record.noise_floor = fit.error.noise_floor / fit.error.unit.factor;
  record.unit = OutputSi(machine);
  for (const Estimate& e : fit.parameters) record.parameters.push_back({e.parameter, e.value, e.std, e.unit});
  return record;
}

Status WriteStatesCsv(const StatesFit& fit, const std::string& path) {
  std::string csv = "log,episode,t";
  const auto out = std::back_inserter(csv);
  const StateModel& model = *fit.fit.model;
  for (const OutputSpec& o : model.machine.states.outputs)
    fmt::format_to(out, ",{},{}_simulated", o.signal, o.signal);
  for (const StateSpec& s : model.machine.states.states) csv += "," + s.name;
  csv += "\n";
  for (std::size_t e = 0; e < fit.log.episodes.size(); ++e) {
    const Episode& episode = fit.log.episodes[e];
    const StateRun& run = fit.fit.runs[e];
    for (int row = 0; row < episode.rows(); ++row) {
      fmt::format_to(out, "{},{},{:.9g}", episode.log, e, episode.time[row]);
      for (int j = 0; j < model.output.rows; ++j)
        fmt::format_to(out, ",{:.9g},{:.9g}", episode.signal(row, model.outputs[j]), run.outputs(row, j));
      for (int i = 0; i < model.states(); ++i) fmt::format_to(out, ",{:.9g}", run.states(row, i));
      csv += "\n";
    }
  }
  return WriteTextFile(path, csv);
}

}  // namespace hydroscope
