#include "service/explain_log.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "service/machine_model.h"

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

/// The model as it is in place of the base balance alone.
void TakeBase(ExplainResult& result) {
  const ExtendedFit& fit = result.explanation.base;
  result.base.theta = fit.theta;
  result.base.covariance = fit.covariance;
  result.base.parameters = BaseParameters(*result.log.model, fit, static_cast<int>(result.strokes));
  result.base.rms_holdout = fit.rms_holdout;
  result.base.noise_floor = fit.noise_floor;
}

}  // namespace

std::string WhyUnmeasured(const UnmeasuredEffect& unmeasured) {
  return fmt::format("the machine file has no signal {}", fmt::join(unmeasured.missing, ", "));
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
  std::shared_ptr<const ModelStructure> model = out.log.model;
  std::vector<StrokeGram> grams = out.log.Grams();
  grams.resize(out.strokes);
  auto base = FitBaseModel(*model, grams, out.log.window);
  if (!base) return tl::unexpected(base.error());
  out.base = std::move(*base);
  ExplainOptions as_is = options;
  as_is.start = out.log.machine.added_effects;
  if (!as_is.start.empty()) {
    auto extended = FitMachineModel(out.log);
    if (!extended) return tl::unexpected(extended.error());
    model = extended->structure;
  }
  out.explanation = ExplainSamples(model, out.log.stretches, out.log.window, as_is);
  if (!out.explanation.base.solved)
    return BadInput(
        "the strokes do not excite all parameters of the model: vary ram speed and pressure, or record "
        "longer");
  if (!as_is.start.empty()) TakeBase(out);
  out.unmeasured = Unmeasured(out.log.machine, *model);
  out.location = Locate(ResidualsOf(out.explanation.model, out.log.stretches, out.log.window,
                                    ColumnWeights(*out.explanation.model, out.explanation.base)));
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
