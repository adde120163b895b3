#pragma once

#include <memory>
#include <vector>

#include "core/bytes.h"
#include "core/records/estimate.h"
#include "core/records/stroke_gram.h"
#include "core/records/stroke_record.h"
#include "estimation/span_equations.h"
#include "models/machine.h"
#include "models/model_structure.h"

namespace hydroscope {

/// A recursive estimator as the pipeline drives it: stretch by stretch, asked for its parameters after each stroke.
class StrokeEstimator {
 public:
  virtual ~StrokeEstimator() = default;
  virtual void AddStretch(const Stretch& stretch, const SpanEquations& equations) = 0;
  /// The stretches since the last stroke were no stroke.
  virtual void DiscardStroke() {}
  /// Physical parameters with intervals after the stroke that `gram` sums up.
  virtual std::vector<Estimate> EndStroke(const StrokeSummary& stroke, const StrokeGram& gram) = 0;
  /// Regression parameters in force, empty before the first stroke.
  virtual Eigen::VectorXd theta() const = 0;
  /// Everything the next stroke depends on; only between strokes.
  virtual void Save(ByteWriter& out) const = 0;
  virtual bool Restore(ByteReader& in) = 0;
};

/// The estimator a machine file asks for.
std::unique_ptr<StrokeEstimator> MakeEstimator(const Machine& machine,
                                               std::shared_ptr<const ModelStructure> model,
                                               const WindowSamples& window);

}  // namespace hydroscope
