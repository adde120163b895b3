#include "monitor/mean_deviation.h"

#include <cmath>

namespace hydroscope {

MeanDeviation MeanDeviationOf(std::span<const AxisMonitor::JudgedValue> strokes, int quantity) {
  MeanDeviation mean;
  double weight = 0;
  for (const AxisMonitor::JudgedValue& stroke : strokes) {
    const drift::Deviation& d = stroke.deviation;
    if (!d.judged || !(d.std[quantity] > 0) || !std::isfinite(d.std[quantity])) continue;
    const double w = 1 / (d.std[quantity] * d.std[quantity]);
    weight += w;
    mean.value += w * d.value[quantity];
    mean.reference += d.reference[quantity];
    mean.doubt += d.doubt[quantity];
    mean.stroke += static_cast<double>(stroke.sequence);
    mean.oil_temperature += stroke.oil_temperature;
    ++mean.strokes;
  }
  if (mean.strokes == 0) return mean;
  mean.value /= weight;
  mean.std = 1 / std::sqrt(weight);
  for (double* sum : {&mean.reference, &mean.doubt, &mean.stroke, &mean.oil_temperature})
    *sum /= mean.strokes;
  return mean;
}

}  // namespace hydroscope
