#include "estimation/stroke_conditions.h"

#include <algorithm>
#include <cmath>

#include "core/constants.h"

namespace hydroscope {

StrokeConditions::StrokeConditions(const ModelStructure& model) {
  for (const Condition& condition : model.conditions)
    courses_.push_back({model.MeasuredChannel(condition.signal), condition.of});
  courses_.push_back({model.temperature_channel, Condition::Of::kMean});
  Begin();
}

void StrokeConditions::Begin() {
  for (Course& course : courses_) course = {course.channel, course.of, 0, 0, -INFINITY, 0, kNaN};
}

void StrokeConditions::Add(std::span<const double> samples, int rows) {
  for (Course& course : courses_) {
    if (course.channel < 0) continue;
    double sum = 0;
    for (const double x : samples.subspan(static_cast<std::size_t>(course.channel * rows), rows)) sum += x;
    course.Add(sum / rows);
  }
}

void StrokeConditions::Course::Add(double mean) {
  if (!std::isfinite(mean)) return;
  sum += mean;
  blocks += 1;
  largest = std::max(largest, mean);
  if (!std::isnan(last)) travel += std::abs(mean - last);
  last = mean;
}

void StrokeConditions::Break() {
  for (Course& course : courses_) course.last = kNaN;
}

double StrokeConditions::Course::Value(double gated_time) const {
  if (blocks == 0) return kNaN;
  if (of == Condition::Of::kMeanRate) return gated_time > 0 ? travel / gated_time : 0.0;
  return of == Condition::Of::kLargest ? largest : sum / blocks;
}

void StrokeConditions::Write(double gated_time, StrokeSummary& summary) const {
  for (std::size_t c = 0; c + 1 < courses_.size(); ++c) summary.conditions[c] = courses_[c].Value(gated_time);
  summary.oil_temperature = courses_.back().Value(gated_time);
}

}  // namespace hydroscope
