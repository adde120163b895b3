#include "service/check_log.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "replay/log_reader.h"
#include "service/confounding.h"
#include "service/geometry_tolerance.h"
#include "service/identifiability.h"
#include "service/live/raw_log.h"
#include "service/machine_model.h"
#include "service/pipeline.h"
#include "service/plausibility.h"

namespace hydroscope {
namespace {

constexpr std::size_t kMostStrokesFitted = 2000;

/// Gathers strokes; of very many, every second, fourth, ... so that memory stays bounded.
class StrokeSample {
 public:
  void Add(StrokeRecord&& record) {
    AddDriving(record.summary);
    if (record.summary.index % stride_ != 0) return;
    kept_.emplace_back(record.summary.index, std::move(record.gram));
    if (kept_.size() <= kMostStrokesFitted) return;
    stride_ *= 2;
    std::erase_if(kept_, [this](const auto& k) { return k.first % stride_ != 0; });
  }
  std::vector<StrokeGram> Grams() const {
    std::vector<StrokeGram> grams;
    for (const auto& [index, gram] : kept_) grams.push_back(gram);
    return grams;
  }
  const Driving& driving() const { return driving_; }

 private:
  void AddDriving(const StrokeSummary& s) {
    const bool first = driving_.strokes++ == 0;
    const auto widen = [first](double x, double& low, double& high) {
      low = first ? x : std::min(low, x);
      high = first ? x : std::max(high, x);
    };
    widen(s.mean_speed, driving_.speed_min, driving_.speed_max);
    widen(s.mean_pressure, driving_.pressure_min, driving_.pressure_max);
    widen(s.oil_temperature, driving_.oil_min, driving_.oil_max);
  }

  Driving driving_;
  std::int64_t stride_ = 1;
  std::vector<std::pair<std::int64_t, StrokeGram>> kept_;
};

void TakeSignals(const SignalSurvey& survey, CheckResult& check) {
  for (std::size_t s = 0; s < check.machine.signals.size(); ++s) {
    const SignalSpec& spec = check.machine.signals[s];
    const auto& absent = check.pass.summary.absent;
    const bool present = std::find(absent.begin(), absent.end(), spec.name) == absent.end();
    check.signals.push_back({spec, survey.ranges()[s], check.pass.channels[s].noise_std, present});
  }
}

void TakeFit(const Result<GramFit>& fit, const ModelStructure& model, CheckResult& check) {
  if (fit) {
    check.rms_holdout = fit->rms_holdout;
    check.noise_floor = fit->noise_floor;
    check.figures = *fit;
    check.parameters = JudgeParameters(fit->parameters, check.driving);
  } else {
    check.no_fit = fit.error().text;
    check.parameters = ParametersWithoutFit(model, check.no_fit, check.driving);
  }
}

/// Rows too far apart tell no parameter.
void DoubtSlowRows(CheckResult& check) {
  const SamplingRate& rate = check.trust.rate;
  if (rate.fast_enough) return;
  for (CheckedParameter& parameter : check.parameters) {
    parameter.verdict = Identifiability::kNot;
    parameter.reason = "sampled too slowly";
    parameter.advice = fmt::format("record a row every {:.3g} ms or faster", 1e3 * rate.needed_period);
  }
}

void TakeConfoundings(const Pipeline& pipeline, const StrokeSample& strokes, CheckResult& check) {
  const std::vector<double> speeds = {check.driving.speed_min, check.driving.speed_max};
  const auto confounded = ConfoundingsOf(check.machine, pipeline.shared_model(), strokes.Grams(), pipeline.window(),
                                         speeds, check.figures);
  for (CheckedParameter& p : check.parameters) {
    const Confounding* confounding = FindConfounding(confounded, p.estimate.parameter);
    if (confounding == nullptr || p.estimate.reason != EstimateReason::kUpdated) continue;
    p.estimate.reason = EstimateReason::kConfounded;
    p.verdict = Identifiability::kNot;
    p.reason = confounding->reason;
    p.advice = confounding->advice;
    p.confounded_with = confounding->effects;
    p.confounded_bias = confounding->bias;
  }
}

/// The strokes of a log as a check needs them: a sample of their Grams, and where effects were added to the model, the
/// samples as well.
class CheckedStrokes {
 public:
  explicit CheckedStrokes(const Machine& machine)
      : extended_(!machine.added_effects.empty()),
        collector_(machine, extended_ ? KeepSamples::kYes : KeepSamples::kNo),
        collect_(collector_.Sink()) {}

  Pipeline::RecordSink Sink() {
    return [this](StrokeRecord&& record) {
      if (extended_) collect_(StrokeRecord(record));
      sample_.Add(std::move(record));
    };
  }
  Pipeline::EquationTap Tap() { return collector_.Tap(); }
  const Driving& driving() const { return sample_.driving(); }
  const StrokeSample& sample() const { return sample_; }
  Result<GramFit> Fit(const Pipeline& pipeline) {
    if (extended_) return FitFigures(collector_.Finish(pipeline));
    return FitBaseModel(pipeline.model(), sample_.Grams(), pipeline.window());
  }

 private:
  bool extended_;
  StrokeSample sample_;
  StrokeCollector collector_;
  Pipeline::RecordSink collect_;
};

}  // namespace

bool CheckResult::Clean() const {
  return pass.summary.rejected_rows == 0 && pass.summary.stopped.empty() && pass.summary.FlaggedValues() == 0;
}

Result<CheckResult> CheckLog(const std::string& log, const std::string& machine_file) {
  auto machine = LoadMachine(machine_file);
  if (!machine) return tl::unexpected(machine.error());
  AssumeTolerances(*machine);
  auto reader = OpenRecording(log, *machine);
  if (!reader) return tl::unexpected(reader.error());
  CheckResult check;
  check.log = log;
  check.machine = *machine;
  check.sample_period = (*reader)->SamplePeriod();

  CheckedStrokes strokes(check.machine);
  FirstStrokes first(*machine);
  std::unique_ptr<Pipeline> pipeline;
  if (machine->model != "valve") {
    auto created = Pipeline::Create(*machine, check.sample_period,
                                    [&first, keep = strokes.Sink()](StrokeRecord&& record) {
                                      first.AddStroke(record);
                                      keep(std::move(record));
                                    });
    if (!created) return tl::unexpected(created.error());
    pipeline = std::move(*created);
    pipeline->set_tap([&first, keep = strokes.Tap()](const Stretch& stretch, const SpanEquations& equations) {
      first.AddStretch(stretch, equations);
      if (keep) keep(stretch, equations);
    });
  }
  SignalSurvey survey(check.machine, check.sample_period);
  LogPassHooks hooks;
  hooks.observe = [&](const SampleBlock& block) { survey.Observe(block); };
  auto pass = PassLog(**reader, check.machine, pipeline.get(), "checking", hooks);
  if (!pass) return tl::unexpected(pass.error());
  if (pass->summary.rows == 0)
    return BadInput("{}: no row could be read{}{}", log, pass->summary.stopped.empty() ? "" : ": ",
                    pass->summary.stopped);
  check.pass = std::move(*pass);
  check.time = survey.time();
  TakeSignals(survey, check);
  if (pipeline) {
    check.conditions = survey.conditions();
    check.driving = strokes.driving();
    check.driving.too_short = pipeline->discarded_strokes();
    TakeFit(strokes.Fit(*pipeline), pipeline->model(), check);
    if (check.no_fit.empty()) TakeConfoundings(*pipeline, strokes.sample(), check);
    check.trust = first.Judge(*pipeline);
    DoubtSlowRows(check);
    check.hints = PlausibilityHints(check);
  }
  return check;
}

}  // namespace hydroscope
