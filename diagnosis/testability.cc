#include "diagnosis/testability.h"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

namespace hydroscope {
namespace {

/// Mean of a channel over a stroke, NaN if it has no finite reading of it.
double StrokeMean(const StrokeStretches& stroke, int channel) {
  double sum = 0, count = 0;
  for (const Stretch& s : stroke)
    for (int k = 0; k < s.samples; ++k)
      if (std::isfinite(s[channel][k])) {
        sum += s[channel][k];
        ++count;
      }
  return sum / count;
}

/// s, of its samples.
double MeanTime(const StrokeStretches& stroke) {
  double sum = 0, count = 0;
  for (const Stretch& s : stroke) {
    sum += s.samples * (s.begin + 0.5 * (s.samples - 1) * s.period);
    count += s.samples;
  }
  return sum / count;
}

std::vector<double> StrokeMeans(std::span<const StrokeStretches> strokes, int channel) {
  std::vector<double> means;
  for (const StrokeStretches& stroke : strokes)
    if (const double mean = StrokeMean(stroke, channel); std::isfinite(mean)) means.push_back(mean);
  return means;
}

}  // namespace

Told WhyUntestable(const Effect& effect, std::span<const double> stroke_means) {
  if (!effect.least_span || stroke_means.empty()) return {};
  const auto [low, high] = std::minmax_element(stroke_means.begin(), stroke_means.end());
  const double span = *high - *low, least = effect.least_span->span;
  if (span >= least) return {};
  return Tell("{0} changed by {2:.1f} {1}, it needs {3:.1f} {1} at least",
              "{0} änderte sich um {2:.1f} {1}, nötig sind mindestens {3:.1f} {1}", effect.least_span->name,
              effect.least_span->unit, span, least);
}

void AddUntestable(const ModelStructure& model, std::span<const StrokeStretches> strokes,
                   std::map<std::string, Told>& untestable) {
  for (const auto* effects : {&model.effects, &model.sample_effects})
    for (const auto& effect : *effects) {
      if (!effect->least_span) continue;
      const Told why = WhyUntestable(*effect, StrokeMeans(strokes, effect->least_span->channel));
      if (!why.empty()) untestable.emplace(effect->id, why);
    }
}

double SharedCourse(std::span<const StrokeStretches> strokes, int channel) {
  if (channel < 0) return 0;
  std::vector<Eigen::Vector2d> means;
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const StrokeStretches& stroke : strokes)
    if (const Eigen::Vector2d m(MeanTime(stroke), StrokeMean(stroke, channel)); m.allFinite()) {
      means.push_back(m);
      mean += m;
    }
  if (means.empty()) return 0;
  mean /= static_cast<double>(means.size());
  Eigen::Matrix2d squares = Eigen::Matrix2d::Zero();
  for (const Eigen::Vector2d& m : means) squares += (m - mean) * (m - mean).transpose();
  const double both = squares(0, 0) * squares(1, 1);
  return both > 0 ? squares(0, 1) * squares(0, 1) / both : 0;
}

}  // namespace hydroscope
