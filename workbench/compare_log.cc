#include "workbench/compare_log.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

#include "core/told_error.h"
#include "diagnosis/free_run.h"
#include "workbench/explain/explain_log.h"

namespace hydroscope {
namespace {

/// Sums of squares of one stroke.
struct Energy {
  double measured = 0, modelled = 0, residual = 0, noise = 0, windows = 0;

  void Add(const StrokeResiduals& stroke) {
    for (int w = 0; w < stroke.windows(); ++w) {
      const double error = stroke.measured[w] - stroke.modelled[w];
      measured += stroke.measured[w] * stroke.measured[w];
      modelled += stroke.modelled[w] * stroke.modelled[w];
      residual += error * error;
      noise += stroke.noise_variance[w];
      windows += 1;
    }
  }
  StrokeComparison Comparison() const {
    StrokeComparison out;
    out.windows = static_cast<int>(windows);
    if (windows <= 0) return out;
    out.rms_measured = std::sqrt(measured / windows);
    out.rms_modelled = std::sqrt(modelled / windows);
    out.rms_residual = std::sqrt(residual / windows);
    out.noise_floor = std::sqrt(noise / windows);
    return out;
  }
};

void AddFreeRun(CompareResult& out) {
  const auto runs = FreeRun(*out.model.structure, out.log.stretches, out.log.window,
                            ColumnWeights(*out.model.structure, out.model.fit));
  if (!runs) return;
  const std::vector<std::size_t> odd = IndicesOf(out.odd);
  double error = 0, measured = 0, blocks = 0;
  for (std::size_t s = 0; s < out.strokes; ++s) {
    const FreeRunStroke& run = (*runs)[s];
    out.per_stroke[s].free_run = run.rms;
    if (std::ranges::binary_search(odd, s)) continue;
    error += run.rms * run.rms * static_cast<double>(run.measured.size());
    for (const double value : run.measured) measured += value * value;
    blocks += static_cast<double>(run.measured.size());
  }
  if (blocks <= 0) return;
  out.overall.free_run = std::sqrt(error / blocks);
  out.rms_run = std::sqrt(measured / blocks);
}

Residuals ResidualsCompared(const CompareResult& compared) {
  return ResidualsOf(compared.model.structure, compared.log.stretches, compared.log.window,
                     ColumnWeights(*compared.model.structure, compared.model.fit));
}

void JudgeOnLogs(CompareResult& out) {
  const JudgedModel judged = JudgeAsExplain(out.log, out.model.structure, out.model.figures);
  if (!judged.explanation.base.solved) return;
  TakeVerdict(judged.explanation, out);
  if (!out.odd.empty()) {
    TakeModelOfTheRest(judged.explanation, out.model);
    out.residuals = ResidualsCompared(out);
  }
  if (HasFloorOfItsOwn(judged.trust, judged.explanation))
    ScaleNoise(judged.explanation.final.noise_floor, out.residuals);
}

/// Of the strokes that do not differ from the rest.
Residuals ResidualsOfTheRest(const CompareResult& compared) {
  Residuals rest = compared.residuals;
  const std::vector<std::size_t> odd = IndicesOf(compared.odd);
  for (auto s = odd.rbegin(); s != odd.rend(); ++s)
    rest.strokes.erase(rest.strokes.begin() + static_cast<std::ptrdiff_t>(*s));
  return rest;
}

}  // namespace

void TakeModelOfTheRest(const Explanation& explanation, MachineModel& model) {
  model.structure = explanation.model;
  model.fit = explanation.base;
  model.choices.clear();
  for (const EffectEstimate& effect : model.fit.effects) model.choices.push_back(effect.choice);
}

void TakeVerdict(const Explanation& explanation, CompareResult& out) {
  out.verdict = explanation.verdict;
  out.may_be_noise = explanation.may_be_noise;
  out.no_verdict = explanation.no_verdict;
  out.warnings = InEnglish(explanation.warnings);
  std::erase(out.warnings, out.no_verdict.english);  // the headline says it
  out.odd = ToldOddStrokesOf(out.log, explanation);
  for (const ToldOddStrokes& odd : out.odd) out.warnings.push_back(odd.sentence.english);
}

LeftOut CompareResult::left_out() const {
  if (odd.empty()) return {strokes, 0, {}};
  return {strokes, IndicesOf(odd).size(), WhichDiffer(log, odd)};
}

std::size_t CompareResult::WorstStroke() const {
  const auto excess = [](const StrokeComparison& s) {
    const double above = s.rms_residual * s.rms_residual - s.noise_floor * s.noise_floor;
    return std::isnan(above) ? -std::numeric_limits<double>::infinity() : above;
  };
  const auto worst = std::ranges::max_element(
      per_stroke, [&](const auto& a, const auto& b) { return excess(a) < excess(b); });
  return static_cast<std::size_t>(worst - per_stroke.begin());
}

ErrorFinding CompareResult::Found() const {
  if (may_be_noise) return ErrorFinding::kMayBeNoise;
  const CompareThresholds limits;
  const bool more =
      verdict ? *verdict != Verdict::kAdequate
              : !location.located.empty() || location.excess > limits.excess_errors * location.excess_std ||
                    overall.rms_residual > limits.visible_error * overall.noise_floor || HasPattern();
  return more ? ErrorFinding::kMore : ErrorFinding::kNoise;
}

bool CompareResult::HasPattern() const {
  return !whiteness.autocorrelation.empty() && whiteness.p_value < CompareThresholds{}.pattern_p;
}

bool CompareResult::IsSignificant(const SignalCorrelation& c) const {
  return c.p_value < CompareThresholds{}.family_error / static_cast<double>(correlations.size());
}

bool CompareResult::IsLagged(const SignalCorrelation& c) const {
  const CompareThresholds limits;
  return c.lag != 0 && c.lagged_p < limits.family_error / static_cast<double>(correlations.size()) &&
         std::abs(c.lagged) > limits.clearly_more * std::abs(c.correlation);
}

StrokeComparison OverallOf(const GramFit& figures) {
  StrokeComparison out;
  out.rms_measured = figures.rms_measured;
  out.rms_modelled = figures.rms_modelled;
  out.rms_residual = figures.rms_residual;
  out.noise_floor = figures.noise_floor;
  return out;
}

Result<CompareResult> CompareLogs(const std::vector<std::string>& logs, const std::string& machine_file,
                                  const std::string& hold_out) {
  const auto machine = TRY(LoadMachine(machine_file));
  const auto chosen = TRY(ChooseLogs(logs, hold_out));
  auto strokes = TRY(ReadStrokes(chosen.fitted, machine, KeepSamples::kYes));
  CompareResult out;
  out.log = std::move(strokes);
  out.strokes = out.log.stretches.size();
  if (out.strokes < 2)
    return BadInput(Tell(
        "{0}: {1} strokes inside the gate, expected at least 2: record longer, or see what the gate of {2} lets "
        "through with 'hydroscope check'",
        "{0}: {1} Hübe im Gate, erwartet: mindestens 2; länger aufzeichnen, oder mit 'hydroscope check' ansehen, was das "
        "Gate von {2} durchlässt",
        fmt::format("{}", fmt::join(chosen.fitted, ", ")), out.strokes, machine_file));
  out.model = TRY(FitMachineModel(out.log));
  out.residuals = ResidualsCompared(out);
  if (out.strokes >= kMinExplainStrokes) JudgeOnLogs(out);
  for (std::size_t s = 0; s < out.strokes; ++s) {
    Energy stroke;
    stroke.Add(out.residuals.strokes[s]);
    out.per_stroke.push_back(stroke.Comparison());
    out.per_stroke.back().stroke = out.log.strokes[s].summary.index;
    out.per_stroke.back().begin = out.log.strokes[s].summary.begin;
    out.per_stroke.back().log = std::filesystem::path(chosen.fitted[out.log.strokes[s].gram.log]).filename();
  }
  out.overall = OverallOf(out.model.figures);
  AddFreeRun(out);
  const Residuals judged = ResidualsOfTheRest(out);
  for (const StrokeResiduals& stroke : judged.strokes) out.overall.windows += stroke.windows();
  out.whiteness = WhitenessOf(judged);
  out.correlations = CorrelationsOf(judged);
  out.location = Locate(judged);
  if (chosen.held_out.empty()) return out;
  out.held_out = TRY(ErrorHeldOut(out.log, chosen.held_out));
  return out;
}

}  // namespace hydroscope
