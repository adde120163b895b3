#include "diagnosis/testability.h"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "machines/die_cushion/balance.h"

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

std::vector<double> StrokeMeans(std::span<const StrokeStretches> strokes, int channel) {
  std::vector<double> means;
  for (const StrokeStretches& stroke : strokes)
    if (const double mean = StrokeMean(stroke, channel); std::isfinite(mean)) means.push_back(mean);
  return means;
}

}  // namespace

std::string WhyUntestable(const Effect& effect, std::span<const double> stroke_means) {
  if (!effect.least_span || stroke_means.empty()) return "";
  const auto [low, high] = std::minmax_element(stroke_means.begin(), stroke_means.end());
  const double span = *high - *low, least = effect.least_span->span;
  if (span >= least) return "";
  if (effect.least_span->channel == kOilTemperature)
    return fmt::format("the oil changed by {:.1f} K, it needs {:.1f} K at least", span, least);
  return fmt::format("a signal it lives on moved by {:.3g}, it needs {:.3g} at least", span, least);
}

void AddUntestable(const ModelStructure& model, std::span<const StrokeStretches> strokes,
                   std::map<std::string, std::string>& untestable) {
  for (const auto* effects : {&model.effects, &model.sample_effects})
    for (const auto& effect : *effects) {
      if (!effect->least_span) continue;
      const std::string why = WhyUntestable(*effect, StrokeMeans(strokes, effect->least_span->channel));
      if (!why.empty()) untestable.emplace(effect->id, why);
    }
}

double SharedCourse(std::span<const StrokeStretches> strokes, int channel, int other) {
  std::vector<Eigen::Vector2d> means;
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const StrokeStretches& stroke : strokes)
    if (const Eigen::Vector2d m(StrokeMean(stroke, channel), StrokeMean(stroke, other)); m.allFinite()) {
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
