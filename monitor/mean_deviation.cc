#include "monitor/mean_deviation.h"

#include <algorithm>
#include <cmath>

#include "core/contains.h"
#include "diagnosis/drift/change_analysis.h"

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

MeanDeviation MeanDeviationBesideFindings(std::span<const AxisMonitor::JudgedValue> strokes, int quantity,
                                          const drift::DriftMonitor& monitor) {
  const auto& quantities = monitor.model().quantities();
  std::vector<int> together = {quantity};
  std::int64_t since = -1;
  for (const drift::DriftFinding& finding : monitor.findings()) {
    if (finding.state == drift::FindingState::kGone || finding.parts.empty()) continue;
    since = std::max(since, finding.since.last_before);
    for (const drift::FindingPart& part : finding.parts)
      for (int q = 0; q < monitor.model().size(); ++q)
        if (quantities[q].name == part.quantity && !Contains(together, q)) together.push_back(q);
  }
  const auto after =
      std::ranges::find_if(strokes, [&](const auto& stroke) { return stroke.sequence > since; });
  const auto later = strokes.last(static_cast<std::size_t>(strokes.end() - after));
  MeanDeviation mean = MeanDeviationOf(later, quantity);
  if (mean.strokes == 0) return MeanDeviationOf(strokes, quantity);
  if (together.size() == 1) return mean;
  Eigen::VectorXd score = Eigen::VectorXd::Zero(monitor.model().size());
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(score.size(), score.size());
  for (const AxisMonitor::JudgedValue& stroke : later) {
    if (!stroke.deviation.judged) continue;
    score += stroke.deviation.score;
    information += stroke.deviation.information;
  }
  const drift::Moved moved = drift::FitTogether(score, information, together).front();
  mean.value = moved.size;
  mean.std = moved.std;
  return mean;
}

}  // namespace hydroscope
