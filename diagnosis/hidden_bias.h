#pragma once

#include <span>
#include <vector>

#include "diagnosis/extended_fit.h"

namespace hydroscope {

/// What an effect that the model lacks would do to one of its physical parameters, were it there at its
/// typical size (Effect::typical): the parameter takes over what the strokes cannot tell from the effect.
struct HiddenBias {
  int effect = 0;          ///< index into ModelStructure::effects
  int parameter = 0;       ///< index into what ModelStructure::derive gives
  double bias = 0;         ///< SI, of the parameter
  double independent = 0;  ///< share of the effect's regressor that the model cannot take over, 0 ... 1
  /// Model error energy over noise energy that the effect would leave beside the model: what could be seen of it.
  double excess_ratio = 0;
};

/// Directions of base parameters and of the effects of `fit` in the model's columns.
Eigen::MatrixXd ModelDirections(const StrokeSet& strokes, const ExtendedFit& fit);

/// By how much each effect of the library with no nonlinear parameter would bias each physical parameter of a
/// model fitted to strokes (omitted variable bias: theta moves by (X'X)^-1 X'g per unit size). Effects that
/// the strokes do not measure are left out.
std::vector<HiddenBias> HiddenBiases(const StrokeSet& strokes, const ExtendedFit& fit);

/// Those that make a parameter a matter of belief: larger than its 95 % interval (`std` per parameter) and
/// than what matters, of effects that the strokes all but mimic by the model and that leave an error nobody
/// sees. Of each parameter, largest first.
std::vector<HiddenBias> ConfoundedBiases(const StrokeSet& strokes, const ExtendedFit& fit,
                                         std::span<const Estimate> parameters);

}  // namespace hydroscope
