#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "storage/database.h"

namespace hydroscope {

/// How far a parameter moved over the strokes looked at: mean of the last third of its updated strokes
/// against the first third, each mean weighted with 1 / std^2. The estimates of neighbouring strokes share
/// data, so averaging is not credited: the std of a mean is that of a typical stroke, (mean of 1 /
/// std^2)^(-1/2). Cautious on purpose.
struct TrendChange {
  double value = 0;          ///< SI, last third minus first third
  double std = 0;            ///< SI
  double from = 0;           ///< SI, mean of the first third
  bool significant = false;  ///< |value| > 1.96 std
  /// % of `from`; nullopt if `from` itself is not clear of zero.
  std::optional<double> Percent() const;
  std::optional<double> PercentStd() const;

  double from_std = 0;  ///< SI
};

/// What the table says about one parameter.
struct TrendSummary {
  std::string parameter, unit;        ///< SI unit
  Estimate latest;                    ///< of the last stroke
  std::int64_t strokes = 0;           ///< strokes looked at
  std::int64_t updated = 0;           ///< of these, strokes that told something about the parameter
  std::optional<std::int64_t> since;  ///< strokes since the last such; nullopt if there was none
  std::optional<TrendChange> change;  ///< nullopt with fewer than 6 updated strokes
  std::vector<double> values;         ///< SI, one per stroke, NaN where nothing is known
  std::vector<double> stds;           ///< SI
};

/// One summary per parameter, in the order of the points; `points` in order of sequence.
std::vector<TrendSummary> SummariseTrends(const std::vector<TrendPoint>& points);

/// The values as a row of `width` block characters (UTF-8), mean per piece, a space where nothing is known.
/// The height spans the values, but at least four typical std, so that noise does not look like a trend.
std::string Sparkline(const std::vector<double>& values, const std::vector<double>& stds, std::size_t width);

}  // namespace hydroscope
