#include "workbench/history/trend_analysis.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/constants.h"
#include "core/contains.h"
#include "core/quantile.h"
#include "models/machine_kind.h"

namespace hydroscope {
namespace {

constexpr std::size_t kLeastBlocksForOil = 6;
constexpr double kLeastOilRange = 1.5;  // K
constexpr double kMostShared = 0.9, kMostCurved = 0.25;
constexpr std::size_t kFewestEstimates = 6;
constexpr double kManyDegrees = 1e4;  ///< the estimator states its std from many samples

TrendSample ToSample(const TrendPoint& point) {
  TrendSample sample;
  sample.sequence = point.sequence;
  sample.value = point.estimate.value;
  sample.std = point.estimate.std;
  sample.temperature = point.oil_temperature;
  sample.reason = point.estimate.reason;
  sample.updated = point.estimate.reason == EstimateReason::kUpdated && std::isfinite(point.estimate.std);
  return sample;
}

/// Blocks as samples of the parameter; values that physics forbids say nothing about it.
std::vector<TrendSample> BlocksOf(const std::vector<BlockEstimates>& blocks, const std::string& parameter) {
  std::vector<TrendSample> samples;
  for (const BlockEstimates& block : blocks)
    for (const Estimate& estimate : block.parameters) {
      if (estimate.parameter != parameter || estimate.reason != EstimateReason::kUpdated ||
          !std::isfinite(estimate.value))
        continue;
      samples.push_back({(block.first + block.last - 1) / 2, estimate.value, estimate.std,
                         block.oil_temperature, true, estimate.reason});
    }
  return samples;
}

/// Columns of the blocks that enter statistics.
struct Series {
  std::vector<double> value, std, temperature, progress;
};

Series SeriesOf(const std::vector<TrendSample>& blocks, bool with_temperature) {
  Series series;
  for (const TrendSample& block : blocks) {
    if (with_temperature && !std::isfinite(block.temperature)) continue;
    series.value.push_back(block.value);
    series.std.push_back(block.std);
    series.temperature.push_back(block.temperature);
    series.progress.push_back(static_cast<double>(block.sequence));
  }
  return series;
}

double ThirdsDifference(const std::vector<double>& values) {
  const auto third = static_cast<std::ptrdiff_t>(values.size() / 3);
  const double first = std::accumulate(values.begin(), values.begin() + third, 0.0);
  const double last = std::accumulate(values.end() - third, values.end(), 0.0);
  return (last - first) / static_cast<double>(std::max<std::ptrdiff_t>(third, 1));
}

/// The change at equal oil temperature: progress is scaled to rise by 1 from the first to the last third.
TestedValue ChangeBeyondOil(const Series& series, const std::vector<double>& one,
                            const std::vector<double>& warmth) {
  std::vector<double> progress = series.progress;
  const double span = ThirdsDifference(progress);
  for (double& p : progress) p = (p - series.progress.front()) / span;
  const CorrelatedFit fit = FitCorrelated({one, warmth, progress}, series.value, series.std, 0);
  return fit.coefficients.empty() ? TestedValue() : fit.coefficients[2];
}

/// Spread (maximum minus minimum over the samples) of a weighted sum of columns.
double Spread(const std::vector<double>& a, double factor_a, const std::vector<double>& b, double factor_b) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double value = factor_a * a[i] + factor_b * b[i];
    low = std::min(low, value);
    high = std::max(high, value);
  }
  return high - low;
}

/// Share of the curved part in a cubic over temperature, and p of none. Legendre polynomials over the range
/// keep straight and curved part apart.
void FindCurvature(const Series& series, const std::vector<double>& one, OilDependence& oil) {
  std::vector<double> p1, p2, p3;
  for (const double t : series.temperature) {
    const double u = 2 * (t - oil.coldest) / (oil.warmest - oil.coldest) - 1;
    p1.push_back(u);
    p2.push_back((3 * u * u - 1) / 2);
    p3.push_back((5 * u * u * u - 3 * u) / 2);
  }
  const CorrelatedFit fit = FitCorrelated({one, p1, p2, p3}, series.value, series.std, 0);
  if (fit.coefficients.empty()) return;
  oil.curved_p = fit.JointP(2);
  const double straight = 2 * std::abs(fit.coefficients[1].value);
  oil.curved_share =
      Spread(p2, fit.coefficients[2].value, p3, fit.coefficients[3].value) / std::max(straight, 1e-300);
}

OilOutcome OutcomeOf(const OilDependence& oil) {
  if (oil.curved_p < kClearBelow && oil.curved_share >= kMostCurved) return OilOutcome::kNotInStep;
  switch (SignificanceOf(oil.slope)) {
    case Significance::kClear:
      return OilOutcome::kFollows;
    case Significance::kHint:
      return OilOutcome::kHint;
    case Significance::kNone:
      return OilOutcome::kNotSeen;
  }
  return OilOutcome::kNotSeen;
}

/// All but what needs the family-wise p.
OilDependence AnalyseOil(const std::vector<TrendSample>& blocks, bool measured) {
  OilDependence oil;
  if (!measured) return oil;
  oil.outcome = OilOutcome::kTooFewStrokes;
  const Series series = SeriesOf(blocks, true);
  if (series.value.size() < kLeastBlocksForOil) return oil;
  const auto [coldest, warmest] = std::ranges::minmax_element(series.temperature);
  oil.coldest = *coldest;
  oil.warmest = *warmest;
  oil.warming = ThirdsDifference(series.temperature);
  oil.outcome = OilOutcome::kOilHardlyMoved;
  if (oil.warmest - oil.coldest < kLeastOilRange) return oil;

  const auto n = static_cast<double>(series.value.size());
  oil.mean_temperature = std::accumulate(series.temperature.begin(), series.temperature.end(), 0.0) / n;
  const std::vector<double> one(series.value.size(), 1.0);
  std::vector<double> warmth = series.temperature;
  for (double& t : warmth) t -= oil.mean_temperature;
  oil.line = FitCorrelated({one, warmth}, series.value, series.std, 0);
  if (oil.line.coefficients.empty()) return oil;
  oil.outcome = OilOutcome::kNotSeen;
  oil.value_at_mean = oil.line.coefficients[0].value;
  oil.slope = oil.line.coefficients[1];
  oil.explained = oil.slope.value * oil.warming;
  FindCurvature(series, one, oil);
  oil.shared_with_time = SquaredCorrelation(series.temperature, series.progress);
  oil.separable = oil.shared_with_time < kMostShared;
  if (oil.separable) oil.beyond = ChangeBeyondOil(series, one, warmth);
  return oil;
}

/// All questions of the report are one family.
void AdjustForAll(std::vector<ParameterAnalysis>& parameters) {
  std::vector<double*> family;
  for (ParameterAnalysis& p : parameters) {
    if (p.change.change.Known()) family.push_back(&p.change.change.p);
    if (p.oil.slope.Known()) family.push_back(&p.oil.slope.p), family.push_back(&p.oil.curved_p);
    if (p.oil.beyond.Known()) family.push_back(&p.oil.beyond.p);
  }
  AdjustForFamily(family);
}

/// How far `value` lies beyond the pair of limits; negative inside.
double Beyond(double value, const std::optional<double>& low, const std::optional<double>& high) {
  double beyond = -std::numeric_limits<double>::infinity();
  if (low) beyond = std::max(beyond, *low - value);
  if (high) beyond = std::max(beyond, value - *high);
  return beyond;
}

double NearerLimit(double value, const std::optional<double>& low, const std::optional<double>& high) {
  if (low && high) return std::abs(value - *low) < std::abs(value - *high) ? *low : *high;
  return low ? *low : high.value_or(kNaN);
}

LimitCheck CheckPair(const std::vector<TrendSample>& samples, double wider, const std::optional<double>& low,
                     const std::optional<double>& high, LimitOutcome touched) {
  LimitCheck check;
  if (!low && !high) return check;
  check.outcome = LimitOutcome::kWithin;
  const TrendSample* latest = nullptr;
  for (const TrendSample& sample : samples) {
    if (!sample.updated) continue;
    latest = &sample;
    check.over_now = Beyond(sample.value, low, high) >= 0;
    if (!check.over_now) continue;
    if (check.strokes++ == 0) {
      check.first_sequence = sample.sequence;
      check.limit = NearerLimit(sample.value, low, high);
    }
    check.outcome = touched;
  }
  if (latest == nullptr) return check;
  const double beyond = Beyond(latest->value, low, high), half = kNormal95 * wider * latest->std;
  check.unsure = check.over_now && beyond <= half;
  if (check.outcome == LimitOutcome::kWithin && beyond + half >= 0) {
    check.outcome = LimitOutcome::kIntervalReaches;
    check.limit = NearerLimit(latest->value, low, high);
  }
  return check;
}

LimitCheck CheckLimits(const std::vector<TrendSample>& samples, double wider, const Machine& machine,
                       const std::string& parameter) {
  const auto spec =
      std::ranges::find_if(machine.monitors, [&](const MonitorSpec& m) { return m.parameter == parameter; });
  if (spec == machine.monitors.end()) return {};
  const LimitCheck alarm =
      CheckPair(samples, wider, spec->alarm_low, spec->alarm_high, LimitOutcome::kAlarmed);
  const LimitCheck warn = CheckPair(samples, wider, spec->warn_low, spec->warn_high, LimitOutcome::kWarned);
  return alarm.outcome >= warn.outcome ? alarm : warn;
}

Significance Unexplained(const ParameterAnalysis& analysis) {
  const Significance change = SignificanceOf(analysis.change.change);
  const OilDependence& oil = analysis.oil;
  const bool oil_acts = oil.outcome == OilOutcome::kFollows || oil.outcome == OilOutcome::kHint;
  if (oil.outcome == OilOutcome::kNotInStep) return std::max(change, Significance::kHint);
  if (!oil_acts) return change;
  return oil.separable ? SignificanceOf(oil.beyond) : Significance::kNone;
}

std::optional<EstimateReason> WhyNot(const ParameterAnalysis& analysis) {
  if (analysis.samples.empty()) return std::nullopt;
  if (analysis.updated > 0)
    return analysis.samples.back().updated ? std::nullopt : std::optional(analysis.samples.back().reason);
  const auto most = std::ranges::max_element(
      analysis.not_updated, [](const auto& a, const auto& b) { return a.second < b.second; });
  return most == analysis.not_updated.end() ? std::nullopt : std::optional(most->first);
}

/// First stroke of the runs at the end that are of one version of the model.
std::int64_t NewestVersionSince(const std::vector<RunInfo>& runs) {
  std::int64_t since = 0;
  const RunInfo* newer = nullptr;
  for (auto run = runs.rbegin(); run != runs.rend(); ++run) {
    if (run->strokes == 0) continue;
    if (newer != nullptr && run->model_version != newer->model_version) return since;
    since = run->first_sequence;
    newer = &*run;
  }
  return since;
}

void Analyse(ParameterAnalysis& analysis, const RecordedHistory& history, bool oil_measured) {
  const std::int64_t since = NewestVersionSince(history.runs);
  if (!analysis.samples.empty() && analysis.samples.front().sequence < since) analysis.version_since = since;
  for (const TrendSample& sample : analysis.samples) {
    if (sample.updated) {
      ++analysis.updated;
      analysis.latest = sample;
    } else {
      ++analysis.not_updated[sample.reason];
    }
  }
  // A parameter the estimator never took for identified has no history to judge.
  if (analysis.updated > 0) analysis.blocks = BlocksOf(history.blocks, analysis.parameter);
  const Series series = SeriesOf(analysis.blocks, false);
  analysis.change = CompareThirds(series.value, series.std, 0);
  analysis.oil = AnalyseOil(analysis.blocks, oil_measured);
  analysis.limits = CheckLimits(analysis.samples, 1, history.machine, analysis.parameter);
  analysis.why_not = WhyNot(analysis);
}

/// What the plot shows is not denied on the strength of blocks that see less.
void HearEstimates(ParameterAnalysis& analysis) {
  std::vector<TrendSample> of_one_model = analysis.samples;
  if (analysis.version_since)
    std::erase_if(of_one_model, [&](const TrendSample& s) { return s.sequence < *analysis.version_since; });
  ThirdsComparison estimates = CompareEstimates(of_one_model);
  if (!estimates.change.Known()) return;
  const bool blocks_tell = analysis.change.change.Known();
  if (blocks_tell && (SignificanceOf(analysis.change.change) != Significance::kNone ||
                      SignificanceOf(estimates.change) == Significance::kNone))
    return;
  if (blocks_tell) estimates.change.p = std::max(estimates.change.p, kClearBelow);
  analysis.change = std::move(estimates);
  analysis.by_estimates = true;
}

/// Where a change begins to matter, SI; infinite where nothing tells.
double WhatMatters(const ParameterAnalysis& analysis, const Machine& machine) {
  double matters = std::numeric_limits<double>::infinity();
  for (const MonitorSpec& spec : machine.monitors)
    for (const auto& limit : {spec.warn_low, spec.warn_high, spec.alarm_low, spec.alarm_high})
      if (spec.parameter == analysis.parameter && limit)
        matters = std::min(matters, std::abs(*limit - analysis.change.first));
  const MachineKind& kind = KindOf(machine);
  const MachineParameter* known = FindParameter(kind, analysis.parameter);
  if (known != nullptr && known->relative) matters = std::min(matters, std::abs(analysis.change.first));
  if (machine.added_effects.empty() || kind.effects == nullptr) return matters;
  for (const auto& effect : kind.effects(machine))
    if (effect->id + "." + effect->parameter == analysis.parameter && effect->typical > 0)
      matters = std::min(matters, effect->typical);
  return matters;
}

constexpr double kClearOfNoise = 2.576;  ///< standard errors of a finding (kClearBelow)

/// Whether a change that matters would have been seen.
void JudgePower(const Machine& machine, ParameterAnalysis& analysis) {
  const TestedValue& change = analysis.change.change;
  if (!change.Known()) return;
  analysis.smallest_seen = kClearOfNoise / kNormal95 * change.HalfWidth();
  analysis.cannot_tell = SignificanceOf(change) == Significance::kNone &&
                         analysis.smallest_seen > WhatMatters(analysis, machine);
}

/// What the family-wise p say.
void Conclude(const Machine& machine, ParameterAnalysis& analysis) {
  HearEstimates(analysis);
  if (analysis.oil.slope.Known()) analysis.oil.outcome = OutcomeOf(analysis.oil);
  analysis.unexplained = Unexplained(analysis);
  JudgePower(machine, analysis);
}

ModelErrorAnalysis AnalyseError(const RecordedHistory& history) {
  std::vector<double> rms, floors, ratios;
  for (const StrokeSummary& stroke : history.strokes) {
    rms.push_back(stroke.rms_error);
    floors.push_back(stroke.noise_floor);
    if (stroke.noise_floor > 0 && std::isfinite(stroke.rms_error))
      ratios.push_back(stroke.rms_error / stroke.noise_floor);
  }
  ModelErrorAnalysis error;
  error.median_rms = Median(rms, kNaN);
  error.median_floor = Median(floors, kNaN);
  error.ratio = CompareThirds(ratios, {}, 0);
  return error;
}

/// Runs have clocks of their own: each counts from its first to its last stroke.
double Duration(const RecordedHistory& history) {
  double duration = 0, begin = kNaN, end = kNaN;
  const auto close = [&] {
    if (std::isfinite(begin) && end > begin) duration += end - begin;
    begin = kNaN;
  };
  std::vector<std::int64_t> starts;
  for (const RunInfo& run : history.runs) starts.push_back(run.first_sequence);
  for (const StrokeSummary& stroke : history.strokes) {
    if (Contains(starts, stroke.index)) close();
    if (!std::isfinite(begin)) begin = stroke.begin;
    end = stroke.end;
  }
  close();
  return duration;
}

/// Weighted mean of estimates, with the std of a typical one of them.
struct CautiousMean {
  double value = 0, std = 0;
};
CautiousMean CautiousMeanOf(const TrendSample* first, std::size_t count) {
  double weights = 0, sum = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const double weight = 1 / (first[k].std * first[k].std);
    weights += weight;
    sum += weight * first[k].value;
  }
  return {sum / weights, std::sqrt(static_cast<double>(count) / weights)};
}

}  // namespace

void StateLatest(double wider, const Machine& machine, ParameterAnalysis& analysis) {
  if (!analysis.latest || !(wider > 1)) return;
  analysis.latest->std *= wider;
  analysis.limits = CheckLimits(analysis.samples, wider, machine, analysis.parameter);
}

ThirdsComparison CompareEstimates(const std::vector<TrendSample>& samples) {
  std::vector<TrendSample> updated;
  for (const TrendSample& sample : samples)
    if (sample.updated && std::isfinite(sample.value) && sample.std > 0) updated.push_back(sample);
  ThirdsComparison result;
  if (updated.size() < kFewestEstimates) return result;
  result.count = updated.size() / 3;
  const CautiousMean early = CautiousMeanOf(updated.data(), result.count);
  const CautiousMean late = CautiousMeanOf(updated.data() + updated.size() - result.count, result.count);
  result.first = early.value;
  result.last = late.value;
  result.first_std = early.std;
  result.change = TestedValue(late.value - early.value, std::hypot(early.std, late.std), kManyDegrees);
  return result;
}

TestedValue ChangeSince(const std::vector<TrendSample>& samples, std::int64_t since) {
  std::vector<TrendSample> before;
  const TrendSample* latest = nullptr;
  for (const TrendSample& sample : samples) {
    if (!sample.updated || !std::isfinite(sample.value) || !(sample.std > 0)) continue;
    if (sample.sequence < since)
      before.push_back(sample);
    else
      latest = &sample;
  }
  if (latest == nullptr || before.size() < kFewestEstimates) return {};
  const CautiousMean mean = CautiousMeanOf(before.data(), before.size());
  return {latest->value - mean.value, std::hypot(mean.std, latest->std), kManyDegrees};
}

void AddSample(const TrendPoint& point, std::vector<ParameterAnalysis>& parameters) {
  auto found = std::ranges::find_if(
      parameters, [&](const ParameterAnalysis& p) { return p.parameter == point.estimate.parameter; });
  if (found == parameters.end()) {
    found = parameters.emplace(parameters.end());
    found->parameter = point.estimate.parameter;
    found->unit = point.estimate.unit;
  }
  if (std::isfinite(point.estimate.value))
    found->samples.push_back(ToSample(point));
  else
    ++found->not_updated[point.estimate.reason];
}

TrendAnalysis AnalyseTrends(const RecordedHistory& history) {
  std::vector<ParameterAnalysis> samples;
  for (const TrendPoint& point : history.trends) AddSample(point, samples);
  return AnalyseTrends(history, std::move(samples));
}

TrendAnalysis AnalyseTrends(const RecordedHistory& history, std::vector<ParameterAnalysis> samples) {
  TrendAnalysis analysis;
  analysis.parameters = std::move(samples);
  analysis.coldest = analysis.warmest = kNaN;
  for (const StrokeSummary& stroke : history.strokes) {
    analysis.coldest = std::fmin(analysis.coldest, stroke.oil_temperature);
    analysis.warmest = std::fmax(analysis.warmest, stroke.oil_temperature);
  }
  for (ParameterAnalysis& parameter : analysis.parameters)
    Analyse(parameter, history, std::isfinite(analysis.coldest));
  AdjustForAll(analysis.parameters);
  for (ParameterAnalysis& parameter : analysis.parameters) Conclude(history.machine, parameter);
  analysis.error = AnalyseError(history);
  analysis.duration = Duration(history);
  return analysis;
}

}  // namespace hydroscope
