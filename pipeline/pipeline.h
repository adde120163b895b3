#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "core/result.h"
#include "core/sample_block.h"
#include "core/stroke_record.h"
#include "estimation/recursive/stroke_estimator.h"
#include "estimation/stroke_accumulator.h"
#include "estimation/stroke_segmenter.h"
#include "models/machine.h"
#include "models/model_structure.h"
#include "pipeline/added_effects_estimator.h"

namespace hydroscope {

/// The way of one sample, for live service and replay alike: samples -> strokes -> equations -> recursive estimator
/// and Gram -> StrokeRecord. Effects that the machine file adds to the model are identified with it. Pure: no clock, no files; the same rows give the same bytes however they are cut into
/// blocks. Blocks come in with their quality flags set (acquisition/quality_monitor.h).
class Pipeline {
 public:
  using RecordSink = std::function<void(StrokeRecord&&)>;
  /// Sees every stretch with its equations, for overlays and for locating errors.
  using EquationTap = std::function<void(const Stretch&, const SpanEquations&)>;

  static Result<std::unique_ptr<Pipeline>> Create(const Machine& machine, double sample_period,
                                                  RecordSink sink);

  /// The tap runs before the equations are forgotten and sees them with all columns, those of added effects behind.
  void set_tap(EquationTap tap) { tap_ = std::move(tap); }
  void Process(const SampleBlock& block) { segmenter_.Process(block); }
  void Finish() { segmenter_.Finish(); }

  /// State between logs: what the estimator learned. Restore refuses a state of another model or version.
  std::vector<std::uint8_t> SaveState() const;
  Status RestoreState(const std::vector<std::uint8_t>& state);

  const ModelStructure& model() const { return *model_; }
  std::shared_ptr<const ModelStructure> shared_model() const { return model_; }
  const WindowSamples& window() const { return window_; }
  const StrokeCounters& totals() const { return segmenter_.totals(); }
  /// The model after the stroke handed over last: modelled output = weights . first rows of SpanEquations::flow. Empty
  /// before the first estimate.
  const Eigen::VectorXd& column_weights() const { return column_weights_; }
  /// s for which the stroke under way has been outside the gate; it is over after GateSpec::stroke_gap.
  double stroke_closed_for() const { return segmenter_.closed_for(); }
  std::int64_t discarded_strokes() const { return segmenter_.discarded_strokes(); }

 private:
  /// `wide` has the columns of added effects behind those of `model`, which are the ones a record's Gram keeps.
  Pipeline(const Machine& machine, std::shared_ptr<const ModelStructure> model,
           std::shared_ptr<const ModelStructure> wide, WindowSamples window, RecordSink sink);
  std::unique_ptr<StrokeEstimator> Estimator(const Machine& machine);
  int Regressors() const { return added_ != nullptr ? added_->regressors() : model_->base_count; }
  void Judge(const StrokeGram& gram, StrokeSummary& summary);
  void OnStretch(Stretch& stretch, double begin);
  void OnStroke(const StrokeSummary& summary);

  std::shared_ptr<const ModelStructure> model_, wide_;
  WindowSamples window_;
  RecordSink sink_;
  EquationTap tap_;
  SpanEquationBuilder equations_;
  StrokeAccumulator accumulator_;
  AddedEffectsEstimator* added_ = nullptr;  ///< the estimator, if the model has added effects
  std::unique_ptr<StrokeEstimator> estimator_;
  Eigen::VectorXd theta_before_;  ///< regression parameters when the present stroke began
  Eigen::VectorXd column_weights_;
  StrokeSegmenter segmenter_;
};

}  // namespace hydroscope
