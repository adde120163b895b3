#pragma once

#include <optional>

#include "estimation/published_filter.h"
#include "estimation/recursive_least_squares.h"
#include "estimation/stroke_estimator.h"

namespace hydroscope {

/// What the published balance knows of the cylinder.
struct PublishedGeometry {
  double piston_area = 0.0;    ///< m^2
  double tank_pressure = 0.0;  ///< Pa
  static PublishedGeometry From(const Machine& machine);
};

/// The identification of the press paper as it was published: moving average, symmetrical derivative, equations 6-8
/// point by point every `update_period`, exponential forgetting. Kept to compare with, not recommended: sensor noise
/// biases it (docs/mathematics.md), and its intervals know nothing of that. Die cushion only.
class PublishedEstimator : public StrokeEstimator {
 public:
  PublishedEstimator(const EstimatorSpec& spec, std::shared_ptr<const ModelStructure> model,
                     const PublishedGeometry& geometry, double period);

  void AddStretch(const Stretch& stretch, const SpanEquations& equations) override;
  std::vector<Estimate> EndStroke(const StrokeSummary& stroke, const StrokeGram& gram) override;
  Eigen::VectorXd theta() const override;
  void Save(ByteWriter& out) const override;
  bool Restore(ByteReader& in) override;

 private:
  void Learn(double p, double p_rate, double z, double speed, double y);

  EstimatorSpec spec_;
  std::shared_ptr<const ModelStructure> model_;
  PublishedGeometry geometry_;
  int update_every_;
  PublishedFilter pressure_, position_, spool_;
  RecursiveLeastSquares rls_;
  int since_update_ = 0;
  double squared_error_ = 0, errors_ = 0;
};

}  // namespace hydroscope
