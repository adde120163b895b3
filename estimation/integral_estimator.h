#pragma once

#include <deque>
#include <optional>

#include "estimation/gram_fit.h"
#include "estimation/information_filter.h"
#include "estimation/stroke_estimator.h"

namespace hydroscope {

/// The default: recursive least squares over the equations of the integral form, span by span, with the noise's share
/// taken out of each span. Directions that a span moves no more than sensor noise does are not forgotten. Spans with
/// errors beyond `clip` standard deviations weigh less. Intervals are the wider of what the noise level promises and what
/// strokes really scatter by.
class IntegralEstimator : public StrokeEstimator {
 public:
  IntegralEstimator(const EstimatorSpec& spec, std::shared_ptr<const ModelStructure> model, const WindowSamples& window);

  void AddStretch(const Stretch& stretch, const SpanEquations& equations) override;
  std::vector<Estimate> EndStroke(const StrokeSummary& stroke, const StrokeGram& gram) override;
  Eigen::VectorXd theta() const override;
  void Save(ByteWriter& out) const override;
  bool Restore(ByteReader& in) override;

 private:
  /// What is remembered of a recent stroke: with and without the noise share.
  struct Recent {
    NormalEquations raw, noise;
  };
  /// Recent strokes summed with the weights that forgetting leaves them.
  struct Weighted {
    Eigen::MatrixXd h, meat;
    double strokes = 0;  ///< effective number
  };
  using Small = InformationFilter::Matrix;

  void Start(const NormalEquations& first);
  /// Takes one span in: augmented Gram (base regressors, then output) of its `count` equations, and the sensor noise's
  /// share of it, SI.
  void LearnSpan(const Small& gram, const Small& noise, int count);
  void Forget(const Small& basis, int count);
  /// Orthonormal basis of the directions that stand out of the sensor noise, scaled units.
  static Small ExcitedDirections(const Small& gram, const Small& noise, int count);
  Weighted Weigh(const Eigen::VectorXd& theta) const;
  Estimate Describe(const DerivedParameter& parameter, const Weighted& recent, const Eigen::MatrixXd& covariance,
                    double own_std) const;
  /// Std of a parameter from one stroke alone; infinite if its regressor is no more than sensor noise there.
  double OwnStd(const DerivedParameter& parameter, const Recent& stroke, const Eigen::VectorXd& theta) const;

  EstimatorSpec spec_;
  std::shared_ptr<const ModelStructure> model_;
  double block_time_;
  std::optional<InformationFilter> filter_;
  Eigen::VectorXd scale_;            ///< scaled regressor = regressor * scale
  double noise_ = 1.0;               ///< output unit of one noise standard deviation at the start
  double variance_ = 1.0;            ///< present variance of the equations in that unit, squared
  bool settled_ = false;             ///< enough strokes to judge a span's errors
  /// Spans seen before the scales were known.
  struct Waiting {
    Small gram, noise;
    int count;
  };
  std::vector<Waiting> waiting_;
  double memory_;                    ///< share of its weight an equation keeps when the next one comes
  std::deque<Recent> recent_;
  std::vector<double> last_excited_; ///< s per physical parameter, NaN = never
};

}  // namespace hydroscope
