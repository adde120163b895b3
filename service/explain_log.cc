#include "service/explain_log.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

namespace hydroscope {
namespace {

std::vector<UnmeasuredEffect> Unmeasured(const Machine& machine, const ModelStructure& model) {
  std::vector<UnmeasuredEffect> out;
  CushionGeometry geometry;
  if (const auto area = machine.Geometry("A_A")) geometry.piston_area = area->value;
  for (auto& effect : DieCushionEffects(geometry)) {
    UnmeasuredEffect entry{effect, {}};
    for (int channel : effect->channels)
      if (model.channel_source[channel] < 0) entry.missing.push_back(model.channel_names[channel]);
    if (!entry.missing.empty()) out.push_back(std::move(entry));
  }
  return out;
}

}  // namespace

std::string WhyUnmeasured(const UnmeasuredEffect& unmeasured) {
  return fmt::format("the machine file has no signal {}", fmt::join(unmeasured.missing, ", "));
}

std::vector<double> ExplainResult::NonlinearOf(const EffectChoice& choice) const {
  for (const auto* ranking : {&explanation.ranking, &explanation.second})
    for (const RankedEffect& ranked : *ranking)
      if (ranked.fit.solved && ranked.fit.effects.back().choice == choice) return ranked.nonlinear;
  return {};
}

std::vector<Estimate> BaseParameters(const ModelStructure& model, const ExtendedFit& fit, int strokes) {
  std::vector<Estimate> out;
  const Eigen::MatrixXd covariance = fit.covariance.topLeftCorner(model.base_count, model.base_count);
  const double student = StudentFactor(strokes - 1.0);
  for (const DerivedParameter& derived : model.derive(fit.theta.head(model.base_count))) {
    Estimate estimate;
    estimate.parameter = derived.name;
    estimate.unit = derived.unit;
    estimate.value = derived.value;
    const double variance = derived.gradient.dot(covariance * derived.gradient);
    estimate.std = std::hypot(student * std::sqrt(std::max(0.0, variance)), derived.geometry_std);
    estimate.reason = derived.admissible ? EstimateReason::kUpdated : EstimateReason::kOutsidePhysics;
    out.push_back(std::move(estimate));
  }
  return out;
}

Result<ExplainResult> ExplainStrokes(LogStrokes strokes, const ExplainOptions& options) {
  ExplainResult out;
  out.log = std::move(strokes);
  out.strokes = out.log.stretches.size();
  if (out.strokes < kMinExplainStrokes)
    return BadInput(
        "{} strokes inside the gate, expected at least {}: the error is judged on strokes left out. Record "
        "longer, or see "
        "what the gate lets through with 'hydroscope check'",
        out.strokes, kMinExplainStrokes);
  const ModelStructure& model = *out.log.model;
  std::vector<StrokeGram> grams = out.log.Grams();
  grams.resize(out.strokes);
  auto base = FitBaseModel(model, grams, out.log.window);
  if (!base) return tl::unexpected(base.error());
  out.base = std::move(*base);
  out.explanation = ExplainSamples(out.log.model, out.log.stretches, out.log.window, options);
  out.unmeasured = Unmeasured(out.log.machine, model);
  if (out.explanation.base.solved)
    out.location = Locate(ResidualsOf(out.log.model, out.log.stretches, out.log.window,
                                      ColumnWeights(model, out.explanation.base)));
  return out;
}

Result<ExplainResult> ExplainLog(const std::string& log, const std::string& machine_file,
                                 const ExplainOptions& options) {
  const auto machine = LoadMachine(machine_file);
  if (!machine) return tl::unexpected(machine.error());
  auto strokes = ReadStrokes(log, *machine, KeepSamples::kYes);
  if (!strokes) return tl::unexpected(strokes.error());
  auto out = ExplainStrokes(std::move(*strokes), options);
  if (!out) return tl::unexpected(Error{out.error().kind, fmt::format("{}: {}", log, out.error().text)});
  out->machine_file = machine_file;
  return out;
}

}  // namespace hydroscope
