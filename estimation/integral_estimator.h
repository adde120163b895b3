#pragma once

#include <deque>
#include <optional>

#include "estimation/gram_fit.h"
#include "estimation/recursive_least_squares.h"
#include "estimation/stroke_estimator.h"

namespace hydroscope {

/// The default: recursive least squares over the equations of the integral form, directional forgetting, with
/// intervals that are the wider of what the noise level promises and what strokes really scatter by.
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
  /// Recent strokes summed with the weights exponential forgetting would give them.
  struct Weighted {
    Eigen::MatrixXd h, noise_h, meat;
    Eigen::VectorXd bias;       ///< noise_h theta - noise_g
    double strokes = 0;         ///< effective number
  };

  void Start(const NormalEquations& first);
  void CreateRecursion(const Eigen::VectorXd& initial);
  void Learn(const double* equation);
  Weighted Weigh(const Eigen::VectorXd& theta) const;
  Estimate Describe(const DerivedParameter& parameter, const Weighted& recent, const Eigen::MatrixXd& covariance,
                    double own_std) const;
  /// Std of a parameter from one stroke alone; infinite if its regressor is no more than sensor noise there.
  double OwnStd(const DerivedParameter& parameter, const Recent& stroke, const Eigen::VectorXd& theta) const;

  EstimatorSpec spec_;
  std::shared_ptr<const ModelStructure> model_;
  double block_time_;
  std::optional<RecursiveLeastSquares> rls_;
  Eigen::VectorXd scale_;            ///< scaled regressor = regressor * scale
  double noise_ = 1.0;               ///< output unit of one noise standard deviation at the start
  double variance_ = 1.0;            ///< present variance of the equations in that unit, squared
  double signal_variance_ = 1.0;     ///< mean square of the output in that unit
  std::vector<double> waiting_;      ///< equations seen before the scales were known
  std::vector<double> equation_;
  std::deque<Recent> recent_;
  std::vector<double> last_excited_; ///< s per physical parameter, NaN = never
};

}  // namespace hydroscope
