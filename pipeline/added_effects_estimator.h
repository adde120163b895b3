#pragma once

#include <deque>
#include <memory>
#include <vector>

#include "diagnosis/extended_fit.h"
#include "estimation/recursive/stroke_estimator.h"

namespace hydroscope {

/// The machine file's estimator for a model with added effects: base and effects are identified together. An
/// effect's regressor is a combination of columns whose weights may depend on the parameters; it is
/// linearised at the parameters after the stroke before. The first kFirstStrokes strokes are collected and
/// fitted at once, which gives the point to start from and, of effects whose nonlinear parameters the machine
/// file does not give, the shape that errs least; until then there are no estimates. Effects count as
/// parameters "internal_leakage.G". A stroke updates a parameter if it tells something about it given the
/// others: at one ram speed a leak cannot be told from a spool offset, but once both are known from earlier
/// strokes, each stroke adds to both.
class AddedEffectsEstimator : public StrokeEstimator {
 public:
  static constexpr std::size_t kFirstStrokes = 4;
  static constexpr std::size_t kMostEffects = 7;

  /// The model of `machine` with shapes for Machine::effect_values behind its columns. Errors: an effect is
  /// not in the library, a signal it needs is not measured, more than kMostEffects, or a value that is no
  /// parameter of the effect.
  static Result<std::shared_ptr<const ModelStructure>> ModelWithValues(const Machine& machine,
                                                                       const ModelStructure& model);

  /// `model` is that of ModelWithValues.
  AddedEffectsEstimator(const Machine& machine, std::shared_ptr<const ModelStructure> model,
                        const WindowSamples& window);

  void AddStretch(const Stretch& stretch, const SpanEquations& equations) override;
  void DiscardStroke() override;
  std::vector<Estimate> EndStroke(const StrokeSummary& stroke, const StrokeGram& gram) override;
  /// Base regression parameters, then the effects' sizes.
  Eigen::VectorXd theta() const override;
  void Save(ByteWriter& out) const override;
  bool Restore(ByteReader& in) override;

  /// The stroke over the regressors of theta() and the output behind them, as linearised at present.
  StrokeGram Reduced(const StrokeGram& gram) const;
  /// Indices into ModelStructure::effects.
  const std::vector<int>& effects() const { return effects_; }
  int regressors() const { return model_->base_count + static_cast<int>(effects_.size()); }
  /// Modelled output = weights . columns of the model, with parameters `theta`; empty without any.
  Eigen::VectorXd ColumnWeights(const Eigen::VectorXd& theta) const;

 private:
  std::size_t StoredTimes() const;  ///< entries of last_excited_
  /// A stroke seen before the start.
  struct Waiting {
    std::vector<SpanEquations> spans;
    StrokeSummary summary;
    StrokeGram gram;
  };

  void Start();
  void Begin();
  void Linearise(const Eigen::VectorXd& theta);
  /// Reasons and excitation given the other parameters.
  void JudgeGivenOthers(const StrokeSummary& stroke, const StrokeGram& reduced,
                        std::vector<Estimate>& estimates);
  SpanEquations Reduced(const SpanEquations& equations) const;
  std::shared_ptr<const ModelStructure> ReducedModel() const;

  Machine machine_;
  std::shared_ptr<const ModelStructure> model_;
  WindowSamples window_;
  std::vector<int> effects_;           ///< indices into ModelStructure::effects
  std::vector<EffectChoice> choices_;  ///< empty before the start
  Eigen::MatrixXd weights_;            ///< columns x (regressors + output)
  std::unique_ptr<StrokeEstimator> inner_;
  std::shared_ptr<const ModelStructure> reduced_;
  std::vector<double> last_excited_;  ///< s per physical parameter, NaN = never
  std::deque<Waiting> waiting_;
  std::vector<SpanEquations> present_;  ///< of the stroke under way, before the start
};

}  // namespace hydroscope
