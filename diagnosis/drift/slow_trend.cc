#include "diagnosis/drift/slow_trend.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/constants.h"
#include "diagnosis/drift/drift_thresholds.h"

namespace hydroscope::drift {
void SlowTrend::Add(std::int64_t sequence, double deviation, double std) {
  if (!(std > 0) || !std::isfinite(std) || !std::isfinite(deviation)) return;
  const double weight = 1.0 / (std * std);
  weight_ += weight;
  sum_ += weight * deviation;
  sequence_sum_ += static_cast<double>(sequence);
  if (++count_ < kDriftThresholds.block_strokes) return;
  blocks_.push_back({sequence_sum_ / count_, sum_ / weight_, std::sqrt(1.0 / weight_)});
  if (blocks_.size() > kDriftThresholds.blocks) blocks_.pop_front();
  weight_ = sum_ = sequence_sum_ = 0;
  count_ = 0;
}

TrendFigures SlowTrend::Figures(double smallest, double doubt) const {
  TrendFigures figures;
  if (blocks_.size() < kDriftThresholds.least_blocks) return figures;
  const double n = static_cast<double>(blocks_.size());
  double mean_x = 0, mean_y = 0;
  for (const Block& b : blocks_) {
    mean_x += b.sequence / n;
    mean_y += b.value / n;
  }
  double xx = 0, xy = 0, promised = 0;
  for (const Block& b : blocks_) {
    xx += std::pow(b.sequence - mean_x, 2);
    xy += (b.sequence - mean_x) * (b.value - mean_y);
    promised += b.std * b.std / n;
  }
  figures.slope = xy / xx;
  std::vector<double> rest;
  double squares = 0, lagged = 0;
  for (const Block& b : blocks_) {
    rest.push_back(b.value - mean_y - figures.slope * (b.sequence - mean_x));
    squares += rest.back() * rest.back();
    if (rest.size() > 1) lagged += rest.back() * rest[rest.size() - 2];
  }
  const double correlation =
      squares > 0 ? std::clamp(lagged / squares, 0.0, kDriftThresholds.most_correlation) : 0;
  const double variance = std::max(promised, squares / (n - 2)) * (1 + correlation) / (1 - correlation);
  figures.slope_std = std::sqrt(variance / xx);
  figures.now = mean_y + figures.slope * (blocks_.back().sequence - mean_x);
  figures.strokes = static_cast<std::int64_t>(blocks_.back().sequence - blocks_.front().sequence);
  const double added = std::abs(figures.slope) * static_cast<double>(figures.strokes);
  figures.significant =
      std::abs(figures.slope) > kDriftThresholds.slope * figures.slope_std && added > smallest + 2 * doubt;
  return figures;
}

TimeToLimit SlowTrend::Reach(const TrendFigures& figures, double limit) {
  const double way = limit - figures.now;
  const auto strokes = [&](double slope) {
    return slope * way > 0 ? way / slope : std::numeric_limits<double>::infinity();
  };
  const double away = std::copysign(kNormal95 * figures.slope_std, way);
  return {strokes(figures.slope), strokes(figures.slope + away), strokes(figures.slope - away)};
}

void SlowTrend::Save(ByteWriter& out) const {
  for (const double v : {weight_, sum_, sequence_sum_}) out.Put(v);
  out.Put(count_);
  out.Put<std::uint32_t>(static_cast<std::uint32_t>(blocks_.size()));
  for (const Block& b : blocks_) out.Put(b);
}

bool SlowTrend::Restore(ByteReader& in) {
  for (double* v : {&weight_, &sum_, &sequence_sum_}) *v = in.Get<double>();
  count_ = in.Get<std::int32_t>();
  const auto size = in.Get<std::uint32_t>();
  blocks_.clear();
  if (size > kDriftThresholds.blocks) return false;
  for (std::uint32_t k = 0; k < size && in.ok(); ++k) blocks_.push_back(in.Get<Block>());
  return in.ok();
}

}  // namespace hydroscope::drift
