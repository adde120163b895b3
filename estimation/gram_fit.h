#pragma once

#include <Eigen/Dense>
#include <span>
#include <string>
#include <vector>

#include "core/records/estimate.h"
#include "core/records/stroke_gram.h"
#include "core/told.h"
#include "estimation/normal_equations.h"
#include "estimation/span_equations.h"
#include "estimation/stroke_clusters.h"
#include "models/model_structure.h"

namespace hydroscope {

/// Sensor noise is taken out of the integral form's Gram (see SpanEquations); kKeep is for comparison only.
enum class NoiseCorrection { kSubtract, kKeep };

/// Integral form, regressors `columns` against `output`.
NormalEquations IntegralEquations(const StrokeGram& gram, std::span<const int> columns, int output,
                                  NoiseCorrection correction = NoiseCorrection::kSubtract);
/// Flow form, for errors in output units.
NormalEquations FlowEquations(const StrokeGram& gram, std::span<const int> columns, int output);

/// Why the equations of strokes have no solution: they do not tell all parameters of the model apart, or there are none, since the
/// log is cut into pieces too short for any.
Told WhyNotSolved(const ModelStructure& model, std::span<const StrokeGram> strokes,
                  const WindowSamples& window);

/// Result of a batch fit of the base model over strokes.
struct GramFit {
  Eigen::VectorXd theta;             ///< regression parameters, SI
  Eigen::MatrixXd covariance;        ///< clustered by stroke (delete-one jackknife) or wider units, SI
  std::vector<Estimate> parameters;  ///< physical parameters; value +- 1.96 std is the 95 % interval
  double rms_measured = 0;           ///< output unit, output (flow form) of these strokes
  double rms_modelled = 0;           ///< output unit
  double rms_residual = 0;           ///< output unit, of their difference, on the strokes of the fit
  double rms_holdout = 0;            ///< output unit, error on strokes the fit did not see
  double noise_floor = 0;            ///< output unit, error that sensor noise alone would cause
  int strokes = 0;
  /// Strokes without which the rest determines no fit: something is known from one stroke alone, and no
  /// interval can be given (std is infinite). They do not enter `rms_holdout`.
  int indispensable_strokes = 0;
  std::int64_t windows = 0;
  StrokeClusters clusters;  ///< left out in turn for the intervals: strokes, unless they hang together
};

/// Fits the base model to a set of strokes. The stroke is the independent unit: intervals come from deleting
/// one stroke at a time (jackknife, Efron 1982; the CR3 estimator of MacKinnon and White 1985) with Student's
/// t of strokes - 1 degrees of freedom; where strokes hang together (estimation/stroke_clusters.h), from
/// deleting one group of them at a time if that is wider. Needs at least two strokes for intervals; with
/// fewer, std is infinite.
Result<GramFit> FitBaseModel(const ModelStructure& model, std::span<const StrokeGram> strokes,
                             const WindowSamples& window);

/// Whether a physical parameter with this value and std can be trusted: kOutsidePhysics, kConfounded if the std
/// is above 0.3 of the value (0.05 of a number without unit) or unknown, else kUpdated.
EstimateReason TrustOf(const DerivedParameter& parameter, double std);

/// The regression parameter that each physical parameter has to itself: the one left over once those of the
/// simpler ones are taken away (K' is theta3, so V0 = A theta2 / theta3 is theta2).
std::vector<int> OwnParameters(const std::vector<DerivedParameter>& derived, const Eigen::VectorXd& theta);

/// Flow error that sensor noise alone would cause, summed over strokes. White noise of a block mean and noise
/// that is integrated (Column::walks) reach a flow differently: a random walk grows over a
/// span, but within the short window of a flow there is little of it.
class NoiseFloorSum {
 public:
  explicit NoiseFloorSum(const WindowSamples& window) : window_(window) {}

  void AddStroke(std::int64_t blocks, std::int64_t spans);
  /// `noise`: share of the integral form that is noise, of one of the strokes or the sum of several, regressors first, output last;
  /// `theta` goes with the regressors, `walk` are the entries of it whose noise is integrated, theta.size() being the output.
  void AddNoise(const Eigen::MatrixXd& noise, const Eigen::VectorXd& theta, std::span<const int> walk);
  /// Output units rms (m^3/s of a volume balance); 0 without any stroke.
  double Rms() const;

 private:
  WindowSamples window_;
  double white_ = 0, equations_ = 0, walk_ = 0, walk_gain_ = 0;
};

/// The same of stored strokes, with regressors `columns` against `output`; `walk` are entries of `columns`,
/// columns.size() being the output.
double NoiseFloor(std::span<const StrokeGram> strokes, std::span<const int> columns, int output,
                  const Eigen::VectorXd& theta, const WindowSamples& window, std::span<const int> walk);

/// Share of each regressor's information that the others do not explain, 0...1.
Eigen::VectorXd Excitation(const Eigen::MatrixXd& h);

/// Factor from a standard error with `degrees` of freedom to the std whose +-1.96 fold is the 95 % interval.
double StudentFactor(double degrees);

}  // namespace hydroscope
