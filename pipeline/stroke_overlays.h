#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/units.h"
#include "pipeline/pipeline.h"

namespace hydroscope {

/// Measured and modelled output of one stroke, for the overlay plot.
struct StrokeOverlay {
  std::int64_t sequence = 0;
  std::vector<double> time;      ///< s
  std::vector<double> measured;  ///< SI
  std::vector<double> modelled;  ///< SI
  std::vector<double> extended;  ///< SI, with the effects that were found; empty without any
  std::string label;             ///< "median error", "largest error"
  double noise_floor = 0;        ///< SI, rms that sensor noise alone would cause
  std::string output;            ///< what is compared, and the unit people read it in
  DisplayUnit unit;
};

/// Collects measured and modelled output of strokes while a log passes the pipeline, for the report's overlay.
/// The modelled output is that of the model after the stroke (Pipeline::column_weights). Memory is bounded: of
/// very many strokes every second, fourth, ... is kept, and always the worst.
class StrokeOverlays {
 public:
  explicit StrokeOverlays(const Pipeline& pipeline) : pipeline_(pipeline) {}

  /// The tap of the pipeline has to hand every span through here, ...
  void AddFlows(const SpanEquations& equations);
  /// ... and its sink every stroke.
  void AddStroke(const StrokeRecord& record);

  /// The stroke of median error and the worst one; `first_sequence` is the machine-wide number of stroke 0.
  std::vector<StrokeOverlay> Choose(std::int64_t first_sequence) const;

 private:
  struct Kept {
    double rms = 0;  ///< SI
    StrokeOverlay overlay;
  };

  Kept Compare(const StrokeRecord& record, const Eigen::VectorXd& weights) const;
  void Keep(Kept stroke);

  const Pipeline& pipeline_;
  std::vector<double> time_;            ///< s, of the stroke under way
  std::vector<Eigen::VectorXd> flows_;  ///< all columns, same rows
  std::int64_t discarded_ = 0;
  std::int64_t stride_ = 1;
  std::vector<Kept> kept_;
  Kept worst_;
};

}  // namespace hydroscope
