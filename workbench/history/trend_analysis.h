#pragma once

#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/records/estimate.h"
#include "core/records/stroke_record.h"
#include "estimation/trend_statistics.h"
#include "models/machine.h"
#include "storage/database.h"
#include "workbench/history/block_estimates.h"

namespace hydroscope {

/// What was recorded and estimated of one machine.
struct RecordedHistory {
  Machine machine;
  std::vector<RunInfo> runs;
  std::vector<StrokeSummary> strokes;  ///< in order; summary.index is the machine-wide sequence here
  std::vector<TrendPoint> trends;      ///< all parameters, in order of sequence
  /// Independent evidence of change and of what follows the oil; empty: nothing is said about either.
  std::vector<BlockEstimates> blocks;
};

/// What the record says about a parameter and the oil temperature.
enum class OilOutcome {
  kNone,            ///< the machine has none that could be measured
  kNotMeasured,     ///< no oil temperature in the record
  kTooFewStrokes,   ///< fewer than 6 blocks of strokes with both
  kOilHardlyMoved,  ///< the oil temperature stayed within 1.5 K
  kNotSeen,  ///< no dependence beyond what chance gives; the interval of the slope says how large one may be
  kHint,     ///< 0.01 <= p < 0.05
  kFollows,  ///< p < 0.01
  kNotInStep,  ///< it moved while the oil warmed or cooled, but clearly not along a straight line
};

struct OilDependence {
  OilOutcome outcome = OilOutcome::kNotMeasured;
  TestedValue slope;                ///< SI of the parameter per K
  double coldest = 0, warmest = 0;  ///< K, of the blocks
  double mean_temperature = 0;  ///< K; the regression line is value_at_mean + slope (T - mean_temperature)
  double value_at_mean = 0;     ///< SI
  CorrelatedFit line;           ///< coefficients of 1 and T - mean_temperature
  /// Size of the curved part over the straight part of a cubic through the blocks, and p of no curvature; at
  /// least a quarter and clear (p < 0.01) makes kNotInStep. Viscosity alone bends the line by less over the
  /// temperatures of a press.
  double curved_share = 0, curved_p = 1;
  double explained = 0;  ///< SI, slope times the warming from the first to the last third
  double warming = 0;    ///< K, last third minus first third
  /// Squared correlation of oil temperature and stroke number: near 1, a slow change of the machine and the
  /// warming oil cannot be told apart in this record.
  double shared_with_time = 0;
  bool separable = false;  ///< shared_with_time is below 0.9
  TestedValue beyond;  ///< SI, change from first to last third at equal oil temperature; only if separable
};

enum class LimitOutcome { kNone, kWithin, kIntervalReaches, kWarned, kAlarmed };

/// The limits of the machine file against every updated estimate.
struct LimitCheck {
  LimitOutcome outcome = LimitOutcome::kNone;
  std::int64_t strokes = 0;         ///< beyond the limit of `outcome`
  std::int64_t first_sequence = 0;  ///< first of them
  double limit = 0;                 ///< SI, the limit touched, or reached by the interval
  bool over_now = false;            ///< the latest estimate is beyond it
  bool unsure = false;              ///< `over_now`, and its interval reaches back over the limit
};

/// One estimate as plotted: of the recursive estimator after a stroke, or of a block of strokes by itself.
struct TrendSample {
  std::int64_t sequence = 0;  ///< of a block: in its middle
  double value = 0, std = 0;  ///< SI
  double temperature = 0;     ///< K, of this stroke or mean over the block
  bool updated = false;
  EstimateReason reason = EstimateReason::kUpdated;
};

struct ParameterAnalysis {
  std::string parameter, unit;       ///< unit: SI
  std::vector<TrendSample> samples;  ///< in order of sequence; finite values only
  /// Independent of each other, in order of sequence; all statistics are theirs, none is of `samples`.
  std::vector<TrendSample> blocks;
  std::size_t updated = 0;  ///< samples that were updated
  std::map<EstimateReason, std::size_t> not_updated;
  std::optional<TrendSample> latest;      ///< last updated sample
  std::optional<EstimateReason> why_not;  ///< most frequent reason if the parameter was never identified, or
                                          ///< the reason of the last stroke if that did not update it
  /// The one judgement of change that card, plot caption and `trends` tell. It rests on the independent
  /// blocks; where these cannot tell, or deny what the estimates plotted show beyond their own uncertainty,
  /// on the estimates (`by_estimates`), in the latter case as a hint at most.
  ThirdsComparison change;
  bool by_estimates = false;
  /// The smallest change over the record that would have been clear, SI; NaN where `change` is not known.
  double smallest_seen = std::numeric_limits<double>::quiet_NaN();
  /// No change stands out, and `smallest_seen` is more than what matters: the way to the nearest limit of the machine file, the
  /// parameter itself where its changes are told in %, or Effect::typical of an effect's size. That is no all-clear.
  bool cannot_tell = false;
  OilDependence oil;
  LimitCheck limits;
  /// First stroke of those estimated with the newest version of the model, where others are older: estimates of two versions are not
  /// compared. Blocks are fitted with one model, all of them.
  std::optional<std::int64_t> version_since;
  /// A change that oil temperature does not explain: clear, and clear at equal oil temperature where that can
  /// be asked.
  Significance unexplained = Significance::kNone;
};

struct ModelErrorAnalysis {
  double median_rms = 0, median_floor = 0;  ///< of the strokes, SI; NaN without strokes
  ThirdsComparison ratio;                   ///< of the strokes' rms error over their noise floor
};

struct TrendAnalysis {
  std::vector<ParameterAnalysis> parameters;  ///< in the order in which they first appear in the trends
  ModelErrorAnalysis error;
  double duration = 0;              ///< s from the first to the last stroke of every run, added up
  double coldest = 0, warmest = 0;  ///< K, NaN if not measured
};

/// One more point, in order of sequence, for the parameter it belongs to: what AnalyseTrends judges. A sample takes a
/// quarter of a TrendPoint, so that a long history need not be held as points.
void AddSample(const TrendPoint& point, std::vector<ParameterAnalysis>& parameters);

/// Compares the last third of the updated estimates with the first. Those of neighbouring strokes share data,
/// so averaging is not credited: the std of a mean is that of a typical stroke, (mean of 1 / std^2)^(-1/2).
/// Cautious on purpose. Unknown below 6 updated estimates.
ThirdsComparison CompareEstimates(const std::vector<TrendSample>& samples);

/// The latest updated estimate less the mean of those before stroke `since`, whose std is that of a typical one. Unknown without
/// an estimate from there on, or with fewer than 6 before.
TestedValue ChangeSince(const std::vector<TrendSample>& samples, std::int64_t since);

/// States the latest updated estimate with an interval that is `wider` times (1 and more) that of its estimator: what all strokes
/// share is no change, but makes uncertain on which side of the machine file's limits it is.
void StateLatest(double wider, const Machine& machine, ParameterAnalysis& analysis);

/// Every p of the result (but that of the model error) is family-wise over all parameters and questions: of a
/// dozen questions one that shows something by chance alone is the rule, not the exception.
TrendAnalysis AnalyseTrends(const RecordedHistory& history);
/// The same of samples that were taken already, in place of `history.trends`.
TrendAnalysis AnalyseTrends(const RecordedHistory& history, std::vector<ParameterAnalysis> samples);

}  // namespace hydroscope
