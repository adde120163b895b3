#include "diagnosis/testability.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "models/die_cushion.h"

namespace hydroscope {
namespace {

/// Mean of a channel over each stroke that has finite readings of it.
std::vector<double> StrokeMeans(std::span<const StrokeStretches> strokes, int channel) {
  std::vector<double> means;
  for (const StrokeStretches& stroke : strokes) {
    double sum = 0, count = 0;
    for (const Stretch& s : stroke)
      for (int k = 0; k < s.samples; ++k)
        if (std::isfinite(s[channel][k])) {
          sum += s[channel][k];
          ++count;
        }
    if (count > 0) means.push_back(sum / count);
  }
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

}  // namespace hydroscope
