#include "workbench/check_log.h"

#include <algorithm>

#include "core/constants.h"
#include "core/contains.h"
#include "core/told_error.h"
#include "estimation/closed_loop/loop_episodes.h"
#include "estimation/closed_loop/reversal.h"
#include "host/work_line.h"
#include "models/closed_loop.h"
#include "models/doubled_signals.h"
#include "models/machine_kind.h"
#include "models/state_model.h"
#include "pipeline/episode_cutter.h"
#include "pipeline/geometry_tolerance.h"
#include "pipeline/log_faults/broken_strokes.h"
#include "pipeline/log_faults/physical_sizes.h"
#include "pipeline/log_faults/stuck_signal.h"
#include "pipeline/pipeline.h"
#include "pipeline/raw_log.h"
#include "pipeline/time_stamps.h"
#include "replay/log_reader.h"
#include "workbench/fit_log.h"
#include "workbench/frequency_response/loop_log.h"
#include "workbench/identifiability.h"
#include "workbench/plausibility.h"
#include "workbench/states/states_log.h"
#include "workbench/states/states_warnings.h"

namespace hydroscope {
namespace {

/// How all strokes were driven.
void AddDriving(const StrokeSummary& s, Driving& driving) {
  const bool first = driving.strokes++ == 0;
  const auto widen = [first](double x, double& low, double& high) {
    low = first ? x : std::min(low, x);
    high = first ? x : std::max(high, x);
  };
  for (std::size_t c = 0; c < driving.ranges.size(); ++c)
    widen(s.conditions[c], driving.ranges[c].low, driving.ranges[c].high);
  widen(s.oil_temperature, driving.oil_min, driving.oil_max);
}

void TakeSignals(const SignalSurvey& survey, CheckResult& check) {
  for (std::size_t s = 0; s < check.machine.signals.size(); ++s) {
    const SignalSpec& spec = check.machine.signals[s];
    const auto& absent = check.pass.summary.absent;
    const bool present = !Contains(absent, spec.name);
    // What a sweep or noise on the command moves from row to row is no noise of a sensor.
    const bool quiet = !MeasuredByResponse(KindOf(check.machine));
    check.signals.push_back(
        {spec, survey.ranges()[s], quiet ? check.pass.channels[s].noise_std : kNaN, present});
  }
}

void TellConfoundings(const std::vector<Confounding>& confounded, CheckResult& check) {
  for (CheckedParameter& p : check.parameters) {
    const Confounding* confounding = FindConfounding(confounded, p.estimate.parameter);
    if (confounding == nullptr || p.estimate.reason != EstimateReason::kConfounded) continue;
    p.verdict = Identifiability::kNot;
    p.reason = confounding->reason;
    p.advice = confounding->advice;
    p.confounded_with = confounding->effects;
    p.confounded_bias = confounding->bias;
  }
}

/// Rows too far apart tell no parameter.
void DoubtSlowRows(CheckResult& check) {
  const SamplingRate& rate = check.trust.rate;
  if (rate.fast_enough) return;
  for (CheckedParameter& parameter : check.parameters) {
    parameter.verdict = Identifiability::kNot;
    parameter.reason = rate.why;
    parameter.advice = Tell("record a row every {:.3g} ms or faster",
                            "eine Zeile alle {:.3g} ms oder schneller aufzeichnen", 1e3 * rate.needed_period);
  }
}

/// More strokes of a machine that the model does not describe make intervals narrower and no truer.
void SendToExplain(CheckResult& check) {
  if (!check.suspicion.ExplainSaysMore()) return;
  for (CheckedParameter& parameter : check.parameters)
    if (parameter.verdict == Identifiability::kWeak) {
      parameter.explain_first = true;
      parameter.advice = Tell("find what the model misses first", "erst finden, was dem Modell fehlt");
    }
}

void TakeFit(Result<FitResult> fitted, const ModelStructure& model, CheckResult& check) {
  if (!fitted) {
    check.no_fit = fitted.error().text;
    const bool stuck = !StuckSignal(check.pass.summary, check.machine, model).empty();
    check.parameters = ParametersWithoutFit(model, check.no_fit, check.driving,
                                            stuck ? Tell("mend what stands below, and record again",
                                                         "beheben, was unten steht, und neu aufzeichnen")
                                                  : Told());
    return;
  }
  check.figures = std::move(fitted->fit);
  check.trust = std::move(fitted->trust);
  check.suspicion = std::move(fitted->suspicion);
  check.parameters = JudgeParameters(check.figures.parameters, check.driving);
  TellConfoundings(fitted->confounded, check);
  SendToExplain(check);
  DoubtSlowRows(check);
}

/// Signals that a model with states takes for inputs; empty for other machines and where the model does not build.
std::vector<std::size_t> StateInputs(const Machine& machine) {
  if (!KindOf(machine).has_states) return {};
  const auto model = BuildStateModel(machine, machine.added_effects);
  return model ? std::vector<std::size_t>((*model)->inputs.begin(), (*model)->inputs.end())
               : std::vector<std::size_t>();
}

/// The rows without the flags that episodes take no notice of.
SampleBlock AsEpisodesTake(SampleBlock rows, const std::vector<std::size_t>& inputs) {
  for (const std::size_t s : inputs)
    for (Quality& flags : rows.quality[s]) flags &= static_cast<Quality>(~EpisodeCutter::kFineOnInputs);
  return rows;
}

/// The same of what was counted.
void CountAsEpisodesTake(const std::vector<std::size_t>& inputs, CheckResult& check) {
  for (const std::size_t s : inputs) {
    const auto counted = check.pass.summary.flagged.find(check.machine.signals[s].name);
    if (counted == check.pass.summary.flagged.end()) continue;
    for (const auto& [flag, name] : quality::kFlagNames)
      if ((flag & EpisodeCutter::kFineOnInputs) != 0) counted->second.erase(std::string(name));
  }
}

/// What a fit of the model with states says of this log.
void TakeStatesFit(const std::string& log, CheckResult& check) {
  auto episodes = ReadEpisodes({log}, check.machine);
  if (!episodes) {
    check.no_fit = episodes.error().text;
    return;
  }
  check.driving.strokes = static_cast<int>(episodes->episodes.size());
  check.pass.summary.gated = check.pass.summary.used = episodes->used;
  WorkLine line("check");
  const auto fit = FitEpisodes(std::move(*episodes), line.Listener());
  if (!fit) {
    check.no_fit = fit.error().text;
    return;
  }
  Driving pieces = check.driving;  // intervals come from pieces of the episodes
  pieces.strokes = static_cast<int>(fit->fit.pieces.size());
  pieces.of_one_log = true;
  check.parameters = JudgeParameters(fit->parameters, pieces);
  check.suspicion.warnings = FitWarnings(*fit);
  check.suspicion.suspected = fit->left.structured;
  SendToExplain(check);
  const double factor = fit->error.unit.factor;
  check.figures.rms_holdout = fit->error.rms_holdout / factor;
  check.figures.noise_floor = fit->error.noise_floor / factor;
  check.noise_at_most = !fit->noise_alone();
  check.figures.rms_residual = fit->error.rms / factor;
  // Of several outputs shares of their variation.
  check.figures.rms_measured = check.figures.rms_modelled =
      fit->fit.noise.size() == 1 ? fit->fit.scale[0] : 1.0;
}

/// Of a machine that is measured by its response: a command or an answer that never moves tells none.
std::string NoResponse(const CheckResult& check) {
  const Machine& machine = check.machine;
  const std::vector<int> moved =
      ClosedLoopOf(machine) != nullptr
          ? SignalsOfLoop(machine)
          : std::vector{machine.SignalIndex(machine.valve.input), machine.SignalIndex(machine.valve.output)};
  for (const int signal : moved) {
    if (signal < 0) continue;
    const CheckedSignal& seen = check.signals[static_cast<std::size_t>(signal)];
    if (seen.present && !(seen.range.max > seen.range.min))
      return seen.spec.name + " does not move in this log";
  }
  return {};
}

/// Of a machine in closed loop, what makes the figures of its response doubtful, or why there is none.
void TakeResponse(const std::string& log, CheckResult& check, std::vector<Told>& doubts) {
  const ClosedLoopPlant* const plant = ClosedLoopOf(check.machine);
  if (plant == nullptr || !check.no_fit.empty()) return;
  const auto measured = MeasureLoopLog(log, check.machine);
  if (!measured) {
    check.no_fit = measured.error().text;
    return;
  }
  const LoopResponse& response = measured->response;
  check.no_fit = response.no_fit.english;
  doubts = NonlinearInputTexts(*plant, response);
  if (response.input_limit) doubts.push_back(InputLimitText(*plant, *response.input_limit));
  if (!response.fit) return;
  Told reversed = ReversedSignal(*plant, response.fit->parameters, ReferencesOf(check.machine));
  if (!reversed.empty()) doubts.push_back(std::move(reversed));
}

/// What stops the commands that conclude, of signals that no hint tells of so far.
void TellSizes(const std::string& log, CheckResult& check) {
  const Status sizes = JudgeSizes(log, check.machine);
  if (sizes) return;
  const Told why = ToldOf(sizes.error());
  const bool told = std::ranges::any_of(check.signals, [&](const CheckedSignal& signal) {
    const std::string name = signal.spec.name + " (column ";
    return why.english.find("signal " + name) != std::string::npos &&
           std::ranges::any_of(check.hints, [&](const Told& hint) { return hint.english.starts_with(name); });
  });
  if (!told) check.hints.push_back(why);
}

/// `known`: an earlier pass over the same log, that found readings to leave out.
Result<CheckResult> LookAt(const std::string& log, const Machine& machine, const LogPass* known = nullptr);

}  // namespace

bool CheckResult::Clean() const {
  return pass.summary.rejected_rows == 0 && pass.summary.stopped.empty() && pass.summary.FlaggedValues() == 0;
}

bool CheckResult::NothingIdentified() const {
  const bool any = std::ranges::any_of(
      parameters, [](const CheckedParameter& p) { return p.verdict != Identifiability::kNot; });
  return !any && (!parameters.empty() || !no_fit.empty());
}

Result<CheckResult> CheckLog(const std::string& log, const std::string& machine_file) {
  auto machine = TRY(LoadMachine(machine_file));
  AssumeTolerances(machine);
  return LookAt(log, machine);
}

namespace {

Result<CheckResult> LookAt(const std::string& log, const Machine& machine, const LogPass* known) {
  auto reader = TRY(OpenRecording(log, machine));
  CheckResult check;
  check.log = log;
  check.machine = machine;
  check.sample_period = reader->SamplePeriod();

  check.driving.words = WordsOf(check.machine);
  for (const Condition& condition : ConditionsOf(check.machine))
    check.driving.ranges.push_back({condition, 0, 0});
  StrokeCollector strokes(check.machine, KeepSamples::kThinned);
  std::unique_ptr<Pipeline> pipeline;
  if (KindOf(machine).build != nullptr) {
    auto created = TRY(Pipeline::Create(machine, check.sample_period,
                                        [&check, keep = strokes.Sink()](StrokeRecord&& record) {
                                          AddDriving(record.summary, check.driving);
                                          keep(std::move(record));
                                        }));
    pipeline = std::move(created);
    pipeline->set_tap(strokes.Tap());
  }
  SignalSurvey survey(check.machine, check.sample_period);
  const std::vector<std::size_t> inputs = StateInputs(check.machine);
  LogPassHooks hooks;
  if (known != nullptr) {
    hooks.known_cut_offs = known->cut_offs;
    hooks.known_frozen = known->frozen;
  }
  hooks.observe = [&](const SampleBlock& block) {
    survey.Observe(inputs.empty() ? block : AsEpisodesTake(block, inputs));
  };
  auto pass = TRY(PassLog(*reader, check.machine, pipeline.get(), "checking", hooks));
  if (pass.summary.rows == 0)
    return BadInput("{}: no row could be read{}{}", log, pass.summary.stopped.empty() ? "" : ": ",
                    pass.summary.stopped);
  if (known == nullptr && pass.WouldLeaveOutMore() && pipeline) return LookAt(log, machine, &pass);
  check.pass = std::move(pass);
  CountAsEpisodesTake(inputs, check);
  check.time = survey.time();
  TakeSignals(survey, check);
  check.time_base = reader->counters().time_base;
  if (pipeline) {
    check.conditions = survey.conditions();
    check.gate = survey.gate();
    check.driving.too_short = pipeline->discarded_strokes();
    if (check.pass.no_verdict.empty() && check.pass.swapped.empty()) {
      LogStrokes kept = strokes.Finish(*pipeline);
      kept.stuck = StuckSignal(check.pass.summary, check.machine, pipeline->model());
      TakeFit(FitStrokes(std::move(kept)), pipeline->model(), check);
    } else
      check.parameters = ParametersWithoutFit(
          pipeline->model(), Tell("readings of a signal are wrong", "Werte eines Signals sind falsch"),
          check.driving,
          Tell("mend what stands below, and record again", "beheben, was unten steht, und neu aufzeichnen"));
    check.hints = PlausibilityHints(check);
    TellSizes(log, check);
    if (const Told broken =
            BrokenUp(check.pass.channels, machine, check.driving.strokes, check.driving.too_short);
        !broken.empty())
      check.hints.push_back(broken);
    if (const Told coarse = CoarseTimeStamps(reader->counters(), machine.signals.size()); !coarse.empty())
      check.hints.insert(check.hints.begin(), coarse);
    const auto clamps = WindowSamples::Clamps(check.machine.window, check.sample_period);
    check.hints.insert(check.hints.end(), clamps.begin(), clamps.end());
  } else {
    std::vector<Told> of_response;
    if (KindOf(machine).has_states) {
      TakeStatesFit(log, check);
    } else {
      check.no_fit = NoResponse(check);
      TakeResponse(log, check, of_response);
    }
    check.hints = PlausibilityHints(check);
    check.hints.insert(check.hints.end(), of_response.begin(), of_response.end());
  }
  for (const DoubledSignals& doubled : DoubledSignalsOf(check.machine))
    check.hints.insert(check.hints.begin(), doubled.text);
  if (const Told& twins = reader->counters().twins; !twins.empty())
    check.hints.insert(check.hints.begin(), twins);
  return check;
}

}  // namespace

}  // namespace hydroscope
