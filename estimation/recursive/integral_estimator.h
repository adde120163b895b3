#pragma once

#include <deque>
#include <optional>
#include <vector>

#include "estimation/gram_fit.h"
#include "estimation/recursive/information_filter.h"
#include "estimation/recursive/stroke_estimator.h"

namespace hydroscope {

/// The default: recursive least squares over the equations of the integral form, with the noise's share taken
/// out (InformationFilter). Spans are weighed one by one: errors beyond `clip` standard deviations count
/// less, those within the dead zone add nothing. The filter learns when the stroke is over, because only a
/// whole stroke shows which directions it excites: within a span the spool hardly moves, and a direction that
/// no single span excites would be learned for ever and never forgotten. Intervals are the wider of what the
/// noise level promises and what strokes really scatter by.
class IntegralEstimator : public StrokeEstimator {
 public:
  IntegralEstimator(const EstimatorSpec& spec, std::shared_ptr<const ModelStructure> model,
                    const WindowSamples& window);

  /// What became of the spans since the start.
  struct SpanCounts {
    std::int64_t learned = 0;       ///< entered with full weight
    std::int64_t clipped = 0;       ///< entered with less
    std::int64_t in_dead_zone = 0;  ///< rms innovation below `dead_zone` standard deviations: added nothing
  };

  void AddStretch(const Stretch& stretch, const SpanEquations& equations) override;
  void DiscardStroke() override { stroke_ = {}; }
  std::vector<Estimate> EndStroke(const StrokeSummary& stroke, const StrokeGram& gram) override;
  Eigen::VectorXd theta() const override;
  void Save(ByteWriter& out) const override;
  bool Restore(ByteReader& in) override;
  const SpanCounts& span_counts() const { return counts_; }

 private:
  /// What is remembered of a recent stroke: with and without the noise share.
  struct Recent {
    NormalEquations raw, noise;
  };
  /// Recent strokes summed with the weights that forgetting leaves them.
  struct Weighted {
    Eigen::MatrixXd h, meat;
    std::vector<double> weights;  ///< newest first, as recent_
    double strokes = 0;           ///< effective number
  };
  using Small = InformationFilter::Matrix;
  /// Augmented Gram (base regressors, then output) of `count` equations and the sensor noise's share of it.
  struct Share {
    Small gram, noise;
    double count = 0;

    void Add(const Share& other, double weight);
  };

  /// The same at its own size: many are kept until the filter starts.
  struct Waiting {
    Eigen::MatrixXd gram, noise;
    double count = 0;
  };

  void Start(const NormalEquations& first, double oil_temperature);
  /// Adds one span, SI, to the stroke under way, in scaled units.
  void LearnSpan(const Share& span);
  /// Takes the stroke under way into the filter.
  void LearnStroke(double oil_temperature);
  void Forget(const Small& basis, double count);
  /// Which regression parameter is behind each physical one, and its time constant.
  void RelateParameters(const Eigen::VectorXd& theta);
  /// Orthonormal basis of the directions that stand out of the sensor noise.
  static Small ExcitedDirections(const Share& stroke);
  Weighted Weigh(const Eigen::VectorXd& theta) const;
  /// As how many strokes that are alike the recent ones tell of what `bread` takes from their scores (StrokesThatTell).
  double StrokesThatTellOf(const Eigen::VectorXd& bread, const Weighted& recent) const;
  Estimate Describe(const DerivedParameter& parameter, const Weighted& recent,
                    const Eigen::MatrixXd& covariance, double own_std) const;
  /// Std of a parameter from one stroke alone; infinite if its regressor is no more than sensor noise there.
  double OwnStd(const DerivedParameter& parameter, int own_regressor, const Recent& stroke) const;
  bool RestoreFilter(ByteReader& in);
  bool RestoreWaiting(ByteReader& in);

  EstimatorSpec spec_;
  std::shared_ptr<const ModelStructure> model_;
  double block_time_;
  std::optional<InformationFilter> filter_;
  Eigen::VectorXd scale_;         ///< scaled regressor = regressor * scale; last entry: of the output
  double noise_ = 1.0;            ///< output unit of one noise standard deviation at the start
  double variance_ = 1.0;         ///< present variance of the equations in that unit, squared
  bool settled_ = false;          ///< enough strokes to judge a span's errors
  Share stroke_;                  ///< stroke under way, scaled units
  std::vector<Waiting> waiting_;  ///< spans seen before the scales were known, SI
  SpanCounts counts_;
  double memory_;  ///< share of its weight an equation keeps when the next one comes
  std::deque<Recent> recent_;
  std::vector<double> last_excited_;    ///< s per physical parameter, NaN = never
  std::vector<int> own_;                ///< regression parameter of each physical one
  std::vector<double> time_constants_;  ///< s per regression parameter
};

}  // namespace hydroscope
