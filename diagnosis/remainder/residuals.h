#pragma once

#include <Eigen/Dense>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "diagnosis/extended_fit.h"
#include "models/stretch.h"

namespace hydroscope {

/// A quantity over which model errors are looked at: a channel of the model, or the phase of the stroke.
struct ResidualSignal {
  std::string name;   ///< p_A, y_v, z, speed, T_oil, pressure_rate, phase
  int channel = -1;   ///< channel of Stretch; -1 = phase, share of the stroke's used samples, 0 ... 1
  double factor = 1;  ///< shown = SI * factor + offset
  double offset = 0;
  std::string unit;  ///< as shown: bar, %, mm, mm/s, °C, bar/s
};

/// Measured against modelled output of one stroke. A window is the triangular flow window of SpanEquations.
struct StrokeResiduals {
  std::vector<double> measured, modelled;  ///< output unit, per window
  /// Output unit squared: what sensor noise adds to measured - modelled, per window.
  std::vector<double> noise_variance;
  Eigen::MatrixXd signal;  ///< signals x windows, SI, means over the window
  /// Integral form, block by block, per span: contrasts of the residual whitened by the covariance that
  /// sensor noise gives them (white level noise and random walk), so that an exact model leaves independent
  /// numbers of variance 1.
  std::vector<Eigen::VectorXd> whitened;

  int windows() const { return static_cast<int>(measured.size()); }
};

struct Residuals {
  std::vector<ResidualSignal> signals;  ///< measured and moving
  std::vector<StrokeResiduals> strokes;
};

/// The model as weights of its columns: modelled output = weights . columns (0 for the output column). `fit`
/// is of base + fit.effects.
Eigen::VectorXd ColumnWeights(const ModelStructure& model, const ExtendedFit& fit);
/// What it leaves of the output, as weights of its columns.
Eigen::VectorXd ErrorWeights(const ModelStructure& model, const ExtendedFit& fit);

/// Residuals of kept strokes. Signals that are not measured (all the same, or not finite) are left out.
Residuals ResidualsOf(std::shared_ptr<const ModelStructure> model, std::span<const StrokeStretches> strokes,
                      const WindowSamples& window, const Eigen::VectorXd& weights);

/// Where the noise shares do not hold: all noise variances, and the whitened contrasts with them, by one factor, so that
/// the mean variance is the square of `noise_floor` (output unit rms).
void ScaleNoise(double noise_floor, Residuals& residuals);

}  // namespace hydroscope
