#pragma once

#include "estimation/recursive/stroke_estimator.h"
#include "estimation/stroke_accumulator.h"
#include "estimation/stroke_segmenter.h"
#include "pipeline/added_effects_estimator.h"
#include "pipeline/pipeline.h"

namespace hydroscope {

/// The way of a sample where a machine has a balance: samples -> strokes -> equations -> recursive estimator and Gram ->
/// StrokeRecord. Effects that the machine file adds to the model are identified with it.
class BalancePipeline : public Pipeline {
 public:
  static Result<std::unique_ptr<Pipeline>> Create(const Machine& machine, double sample_period,
                                                  RecordSink sink);

  void Process(const SampleBlock& block) override { segmenter_.Process(block); }
  void Finish() override { segmenter_.Finish(); }
  std::vector<std::uint8_t> SaveState() const override;
  Status RestoreState(const std::vector<std::uint8_t>& state) override;
  const StrokeCounters& totals() const override { return segmenter_.totals(); }
  const Eigen::VectorXd& column_weights() const override { return column_weights_; }
  double stroke_closed_for() const override { return segmenter_.closed_for(); }
  std::int64_t discarded_strokes() const override { return segmenter_.discarded_strokes(); }

 private:
  /// `wide` has the columns of added effects behind those of `model`, which are the ones a record's Gram keeps.
  BalancePipeline(const Machine& machine, std::shared_ptr<const ModelStructure> model,
                  std::shared_ptr<const ModelStructure> wide, WindowSamples window, RecordSink sink);
  std::unique_ptr<StrokeEstimator> Estimator(const Machine& machine);
  int Regressors() const { return added_ != nullptr ? added_->regressors() : model().base_count; }
  void Judge(const StrokeGram& gram, StrokeSummary& summary);
  void OnStretch(Stretch& stretch, double begin);
  void OnStroke(const StrokeSummary& summary);

  std::shared_ptr<const ModelStructure> wide_;
  RecordSink sink_;
  SpanEquationBuilder equations_;
  StrokeAccumulator accumulator_;
  AddedEffectsEstimator* added_ = nullptr;  ///< the estimator, if the model has added effects
  std::unique_ptr<StrokeEstimator> estimator_;
  Eigen::VectorXd theta_before_;  ///< regression parameters when the present stroke began
  Eigen::VectorXd column_weights_;
  StrokeSegmenter segmenter_;
};

}  // namespace hydroscope
