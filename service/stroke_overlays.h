#pragma once

#include <vector>

#include "estimation/gram_fit.h"
#include "service/pipeline.h"
#include "service/report.h"

namespace hydroscope {

/// Collects measured and modelled flow of strokes while a log passes the pipeline, for the report's overlay.
/// The modelled flow is that of the parameters after the stroke: least squares over the stroke and those
/// before it in the log, weighted with the estimator's time constant. Memory is bounded: of very many strokes
/// every second, fourth, ... is kept, and always the worst.
class StrokeOverlays {
 public:
  /// Takes over the tap of `pipeline`; lives as long as it.
  StrokeOverlays(Pipeline& pipeline, const Machine& machine);

  /// The sink of the pipeline has to hand every stroke through here.
  void AddStroke(const StrokeRecord& record);

  /// The stroke of median error and the worst one; `first_sequence` is the machine-wide number of stroke 0.
  std::vector<StrokeOverlay> Choose(std::int64_t first_sequence) const;

 private:
  struct Kept {
    double rms = 0;  ///< m^3/s
    StrokeOverlay overlay;
  };

  void AddFlows(const SpanEquations& equations);
  Eigen::VectorXd Learn(const StrokeRecord& record);
  Kept Compare(const StrokeRecord& record, const Eigen::VectorXd& theta) const;
  void Keep(Kept stroke);

  Pipeline& pipeline_;
  double time_constant_;  ///< s of data
  NormalEquations recent_;
  std::vector<double> time_;                 ///< s, of the stroke under way
  std::vector<std::vector<double>> column_;  ///< base columns and output, same rows
  std::int64_t discarded_ = 0;
  std::int64_t stride_ = 1;
  std::vector<Kept> kept_;
  Kept worst_;
};

}  // namespace hydroscope
