#pragma once

#include <Eigen/Dense>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "core/records/stroke_gram.h"
#include "diagnosis/stroke_forms.h"
#include "estimation/gram_fit.h"
#include "estimation/span_equations.h"
#include "models/effect.h"
#include "models/model_structure.h"

namespace hydroscope {

/// An effect of the model's library in one of its shapes.
struct EffectChoice {
  int effect = 0;  ///< index into ModelStructure::effects
  int shape = 0;   ///< index into ModelStructure::effect_shapes[effect]
  bool operator==(const EffectChoice&) const = default;
};

/// Shapes of `effect` for a model that has `others`: those on the signals as one of these corrects them, else
/// those on the signals as measured.
std::vector<int> ShapesFor(const ModelStructure& model, int effect, std::span<const EffectChoice> others);

/// What the signals of effect number `k` of a model are corrected by: the first effect that acts on signals and is not
/// `k`; of two such effects the second one's by the first. `values` are their nonlinear parameters.
std::optional<Correction> CorrectionOf(const ModelStructure& model, std::span<const EffectChoice> choices,
                                       std::span<const std::vector<double>> values, std::size_t k);

/// One added effect as fitted.
struct EffectEstimate {
  EffectChoice choice;
  double size = 0;         ///< linear parameter, SI
  double std = 0;          ///< clustered by stroke; +-1.96 std is the 95 % interval
  double model_std = 0;    ///< what the sensor noise alone promises
  bool admissible = true;  ///< sign and size within Effect::min ... max
  bool consistent = true;  ///< Effect::implied agrees with the shape's nonlinear parameter
  /// Of the shape's nonlinear parameters; [] if not found out (WidenByNonlinear).
  std::vector<double> nonlinear_std;
  double independent = 0;  ///< share of its regressor the base model cannot mimic, 0...1 (1 - R^2)
};

/// A model = base + effects, fitted to a set of strokes and judged on strokes it did not see.
struct ExtendedFit {
  bool solved = false;         ///< false: the strokes cannot separate its parameters
  Eigen::VectorXd theta;       ///< base regression parameters, then the effects' sizes
  Eigen::MatrixXd covariance;  ///< of theta, clustered by stroke
  std::vector<EffectEstimate> effects;
  /// Per stroke, held out: model error energy sum, output unit squared (noise taken out). NaN where a signal
  /// that the effects need was bad: such strokes are left out.
  Eigen::VectorXd excess;
  double noise_variance = 0;    ///< of one equation, integrated output unit squared
  double excess_ratio = 0;      ///< mean held-out model error energy over noise energy; 0 = perfect model
  double excess_error = 0;      ///< standard error of `excess_ratio`, from its scatter between strokes
  double fit_excess_ratio = 0;  ///< the same on the strokes it was fitted to
  double rms_measured = 0, rms_modelled = 0, rms_residual = 0;  ///< as in GramFit
  int indispensable_strokes = 0;  ///< as in GramFit; they do not enter `rms_holdout`
  double rms_holdout = 0;         ///< output unit, flow form
  double noise_floor = 0;         ///< output unit, flow form, sensor noise alone
  /// Per stroke, held out: flow form, sum of squared errors; NaN as `excess`.
  Eigen::VectorXd flow_error;
  StrokeClusters clusters;   ///< what the intervals were made of: strokes, or after Widen groups of them
  Eigen::VectorXd widening;  ///< by how much Widen made the standard errors of theta wider; empty: by nothing
};

/// Standard error of the sum of ExtendedFit::excess, from its scatter between strokes.
double ExcessStd(const ExtendedFit& fit);

/// Multiplies the standard errors of theta and of the effects' sizes by `factor`, one per entry of theta.
void ScaleScatter(const Eigen::VectorXd& factor, ExtendedFit& fit);

/// A packed Gram as a full symmetric matrix.
Eigen::MatrixXd Unpacked(const SymmetricMatrix& packed);

/// Strokes prepared for many fits: Grams with the noise share taken out, and the shares themselves.
class StrokeSet {
 public:
  /// `noise_scale`: noise energy over what the noise shares say, where these are not believable.
  StrokeSet(std::shared_ptr<const ModelStructure> model, std::vector<StrokeGram> strokes,
            const WindowSamples& window, double noise_scale = 1.0);

  /// Fits base + `choices`; composite effects are re-linearised around the result until it settles.
  ExtendedFit Fit(std::span<const EffectChoice> choices) const;

  /// Where strokes hang together, or few of them tell most (estimation/stroke_clusters.h), widens covariance and
  /// effects' std of a fit of base + `choices`. For intervals that are shown; the search weighs by strokes.
  void Widen(std::span<const EffectChoice> choices, ExtendedFit& fit) const;

  const ModelStructure& model() const { return *model_; }
  const std::shared_ptr<const ModelStructure>& shared_model() const { return model_; }
  /// Integral-form Gram of all strokes over all columns, noise taken out.
  Eigen::MatrixXd Total() const;
  std::vector<Eigen::MatrixXd> TotalOfEach() const;  ///< of each stroke by itself
  /// The same of the flow form, noise and all.
  Eigen::MatrixXd TotalFlow() const;
  /// An effect of unit size as a combination of the model's columns, linearised at `theta` (base parameters, size).
  Eigen::VectorXd Direction(const EffectChoice& choice, const Eigen::VectorXd& theta) const;
  /// The output's energy of all strokes in the integral form, noise taken out.
  double OutputEnergy() const;
  int strokes() const { return static_cast<int>(strokes_.size()); }
  double equations() const { return equations_; }
  double student() const { return OfAll().student; }  ///< StudentFactor of a scatter over all strokes
  double period() const { return window_.period; }    ///< s between rows
  double Equations(std::size_t stroke) const { return strokes_[stroke]->equations(); }
  /// Whether the effect's columns were measured (finite and not all zero) in enough strokes to be judged.
  bool Measured(const EffectChoice& choice) const;
  /// The strokes in which every signal of the library was good, if a sensor was bad in some but not in most:
  /// on them all effects can be compared. Nothing if all strokes serve, or too few.
  std::optional<StrokeSet> Comparable() const;
  /// The strokes of these indices alone.
  StrokeSet Only(std::span<const std::size_t> strokes) const;
  /// All strokes, with the library's effects, but for `everywhere`, at work in those of these indices alone.
  StrokeSet WithEffectsIn(std::span<const std::size_t> strokes,
                          std::span<const EffectChoice> everywhere) const;
  /// Error energy per noise energy of a stroke under `fit`, as excess_ratio is of all.
  double ExcessRatio(const ExtendedFit& fit, std::size_t stroke) const;
  /// Strokes in which every signal the effects need was good.
  std::vector<std::size_t> Usable(std::span<const EffectChoice> choices) const;
  /// The shape of `effect` that errs least on strokes left out, in a model that has `others` already, of those
  /// with a size that physics allows if there are any; shape -1 if none can be fitted.
  EffectChoice BestShape(int effect, std::span<const EffectChoice> others) const;

 private:
  struct Stroke {
    SymmetricMatrix clean, noise, flow;
    std::int64_t blocks = 0, spans = 0;
    int log = 0;
    double windows = 0;
    std::vector<bool> bad;  ///< per column: a signal it needs was bad

    double equations() const { return static_cast<double>(blocks - spans); }
    void TakeOut(int column);
  };
  SparseColumns Composite(std::span<const EffectChoice> choices, const Eigen::VectorXd& theta) const;
  void Judge(const SparseColumns& columns, std::span<const std::size_t> strokes,
             std::span<const EffectChoice> choices, ExtendedFit& fit) const;

  std::shared_ptr<const ModelStructure> model_;
  WindowSamples window_;
  /// What is formed of all strokes when it is first asked for.
  struct Formed {
    explicit Formed(std::span<const std::shared_ptr<const Stroke>> strokes);
    SymmetricMatrix total;  ///< of `clean`
    GramElements clean, noise, flow;
    double student;
  };
  Formed& OfAll() const;
  struct Lazily {
    std::once_flag formed;
    std::unique_ptr<Formed> of_all;
  };

  std::vector<std::shared_ptr<const Stroke>> strokes_;  ///< shared by the sets that hold them
  std::shared_ptr<Lazily> lazily_ = std::make_shared<Lazily>();
  double noise_scale_ = 1.0;
  double equations_ = 0;
};

}  // namespace hydroscope
