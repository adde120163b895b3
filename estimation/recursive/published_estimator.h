#pragma once

#include <vector>

#include "estimation/recursive/published_filter.h"
#include "estimation/recursive/recursive_least_squares.h"
#include "estimation/recursive/stroke_estimator.h"

namespace hydroscope {

/// The identification of the press paper as it was published: moving average, symmetrical derivative, the balance
/// (ModelStructure::published, which the model must have) point by point every `update_period`, exponential forgetting.
/// Kept to compare with, not recommended: sensor noise biases it (docs/mathematics.md),
/// and its intervals know nothing of that.
class PublishedEstimator : public StrokeEstimator {
 public:
  PublishedEstimator(const EstimatorSpec& spec, std::shared_ptr<const ModelStructure> model, double period);

  void AddStretch(const Stretch& stretch, const SpanEquations& equations) override;
  std::vector<Estimate> EndStroke(const StrokeSummary& stroke, const StrokeGram& gram) override;
  Eigen::VectorXd theta() const override;
  void Save(ByteWriter& out) const override;
  bool Restore(ByteReader& in) override;

 private:
  bool Push(const Stretch& stretch, int sample);
  void Learn();
  Eigen::VectorXd Units() const;

  EstimatorSpec spec_;
  std::shared_ptr<const ModelStructure> model_;
  int update_every_;
  std::vector<PublishedFilter> filters_;  ///< of PublishedForm::channels
  std::vector<double> value_, rate_, balance_;
  RecursiveLeastSquares rls_;
  int since_update_ = 0;
  double squared_error_ = 0, errors_ = 0;
};

}  // namespace hydroscope
