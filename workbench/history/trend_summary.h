#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "models/machine_kind.h"
#include "storage/database.h"
#include "workbench/explain/confounding.h"
#include "workbench/history/block_estimates.h"
#include "workbench/history/trend_analysis.h"

namespace hydroscope {

/// How far a parameter moved over the strokes looked at, last third against first: the judgement of the
/// report's card (ParameterAnalysis::change).
struct TrendChange {
  double value = 0;          ///< SI, last third minus first third
  double std = 0;            ///< SI
  double from = 0;           ///< SI, mean of the first third
  double from_std = 0;       ///< SI
  double p = 1;              ///< of no change
  bool significant = false;  ///< clear
  bool hint = false;         ///< more than chance, less than clear
  bool with_oil = false;     ///< oil temperature accounts for it
  double smallest_seen = 0;  ///< ParameterAnalysis::smallest_seen
  bool cannot_tell = false;  ///< ParameterAnalysis::cannot_tell
  /// % of `from`; nullopt where that says nothing (core/relative_change.h).
  std::optional<double> Percent() const;
  std::optional<double> PercentStd() const;
};

/// What the table says about one parameter.
struct TrendSummary {
  std::string parameter, unit;            ///< SI unit
  const MachineKind* kind = nullptr;      ///< of its machine, which says in what unit people read it
  Estimate latest;                        ///< of the last stroke
  std::optional<Confounding> confounded;  ///< nothing: no effect could move it unseen, or nobody asked
  Told
      not_trusted;  ///< EstimateStatement::why, of `confounded` or of the error of the fit to the last run; "" if nothing is
  std::int64_t latest_sequence = 0;           ///< its number
  std::int64_t strokes = 0;                   ///< strokes looked at
  std::int64_t updated = 0;                   ///< of these, strokes that told something about the parameter
  std::optional<std::int64_t> since;          ///< strokes since the last such; nullopt if there was none
  std::optional<TrendChange> change;          ///< nullopt with too few strokes to tell
  std::optional<std::int64_t> version_since;  ///< ParameterAnalysis::version_since
  std::vector<double> values;                 ///< SI, one per stroke, NaN where nothing is known
  std::vector<double> stds;                   ///< SI
};

/// Takes the points of a machine one by one and sums them up without keeping them.
class TrendSummariser {
 public:
  /// In order of sequence.
  void Add(const TrendPoint& point);
  /// One summary per parameter, in the order in which they came. What is known of the same strokes but for the points themselves:
  /// the judgement rests on it, as in the report.
  std::vector<TrendSummary> Finish(const RecordedHistory& history = {}) &&;

 private:
  std::vector<TrendSummary> summaries_;
  std::vector<ParameterAnalysis> samples_;
};

/// The summaries of points that are at hand.
std::vector<TrendSummary> SummariseTrends(const std::vector<TrendPoint>& points,
                                          const RecordedHistory& history = {});

/// The values as a row of `width` block characters (UTF-8), mean per piece, a space where nothing is known.
/// The height spans the values, but at least four typical std, so that noise does not look like a trend.
std::string Sparkline(const std::vector<double>& values, const std::vector<double>& stds, std::size_t width);

}  // namespace hydroscope
