#include "workbench/history/trend_summary.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/constants.h"
#include "core/quantile.h"
#include "core/relative_change.h"
#include "workbench/history/trend_analysis.h"

namespace hydroscope {
namespace {

std::optional<TrendChange> ChangeOf(const ParameterAnalysis& analysis) {
  const TestedValue& tested = analysis.change.change;
  if (!tested.Known()) return std::nullopt;
  const Significance significance = SignificanceOf(tested);
  TrendChange change;
  change.value = tested.value;
  change.std = tested.HalfWidth() / kNormal95;
  change.from = analysis.change.first;
  change.from_std = analysis.change.first_std;
  change.p = tested.p;
  change.significant = significance == Significance::kClear;
  change.hint = significance == Significance::kHint;
  change.smallest_seen = analysis.smallest_seen;
  change.cannot_tell = analysis.cannot_tell;
  change.with_oil = change.significant && analysis.unexplained == Significance::kNone;
  return change;
}

/// Mean of the known values of each of `width` equal pieces; NaN where a piece has none.
std::vector<double> PieceMeans(const std::vector<double>& values, std::size_t width) {
  const std::size_t pieces = std::min(width, values.size());
  std::vector<double> means;
  for (std::size_t piece = 0; piece < pieces; ++piece) {
    double sum = 0, count = 0;
    for (std::size_t i = piece * values.size() / pieces; i < (piece + 1) * values.size() / pieces; ++i) {
      if (!std::isfinite(values[i])) continue;
      sum += values[i];
      count += 1;
    }
    means.push_back(count > 0 ? sum / count : std::numeric_limits<double>::quiet_NaN());
  }
  return means;
}

}  // namespace

std::optional<double> TrendChange::Percent() const {
  const auto share = RelativeChange(from, from_std, value);
  return share ? std::optional(100 * *share) : std::nullopt;
}

std::optional<double> TrendChange::PercentStd() const {
  if (!Percent()) return std::nullopt;
  return 100 * std / std::abs(from);
}

void TrendSummariser::Add(const TrendPoint& point) {
  AddSample(point, samples_);
  const Estimate& e = point.estimate;
  auto summary =
      std::ranges::find_if(summaries_, [&](const TrendSummary& s) { return s.parameter == e.parameter; });
  if (summary == summaries_.end()) {
    summary = summaries_.emplace(summaries_.end());
    summary->parameter = e.parameter;
    summary->unit = e.unit;
  }
  if (summary->since) *summary->since += point.sequence - summary->latest_sequence;
  if (e.reason == EstimateReason::kUpdated) {
    ++summary->updated;
    summary->since = 0;
  }
  summary->latest = e;
  summary->latest_sequence = point.sequence;
  ++summary->strokes;
  summary->values.push_back(e.value);
  summary->stds.push_back(e.std);
}

std::vector<TrendSummary> TrendSummariser::Finish(const RecordedHistory& history) && {
  for (const ParameterAnalysis& analysis : AnalyseTrends(history, std::move(samples_)).parameters)
    for (TrendSummary& summary : summaries_)
      if (summary.parameter == analysis.parameter) {
        summary.change = ChangeOf(analysis);
        summary.version_since = analysis.version_since;
      }
  return std::move(summaries_);
}

std::vector<TrendSummary> SummariseTrends(const std::vector<TrendPoint>& points,
                                          const RecordedHistory& history) {
  TrendSummariser summariser;
  for (const TrendPoint& point : points) summariser.Add(point);
  return std::move(summariser).Finish(history);
}

std::string Sparkline(const std::vector<double>& values, const std::vector<double>& stds, std::size_t width) {
  static constexpr std::array<const char*, 8> kBars = {"▁", "▂", "▃", "▄", "▅", "▆", "▇", "█"};
  const std::vector<double> means = PieceMeans(values, width);
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const double mean : means) {
    if (!std::isfinite(mean)) continue;
    low = std::min(low, mean);
    high = std::max(high, mean);
  }
  const double height = std::max(high - low, 4 * Median(stds, 0));
  const double bottom = (low + high - height) / 2;
  std::string line;
  for (const double mean : means) {
    if (!std::isfinite(mean)) {
      line += ' ';
      continue;
    }
    const double share = height > 0 ? (mean - bottom) / height : 0.5;
    line += kBars[std::clamp(share * kBars.size(), 0.0, kBars.size() - 1.0)];
  }
  return line;
}

}  // namespace hydroscope
