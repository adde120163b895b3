#pragma once

#include <Eigen/Dense>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "diagnosis/extended_fit.h"
#include "models/stretch.h"

namespace hydroscope {

/// Thresholds of the predictability test, validated by `hydroscope benchmark hidden-effects`
/// and `plant-logs` (docs/workbench.md).
struct PredictabilityOptions {
  double max_p = 0.01;      ///< p-value from which on what is left counts as structure
  double min_share = 0.03;  ///< ... if it is this share of the error's energy
  /// ... or this one where the noise floor is believable and the error near it: features of a noisy signal share
  /// its noise with the regressors that integrate it, which predicts some percent of healthy errors.
  double min_share_at_floor = 0.10;
  double of_base = 0.005;   ///< ... and this share of what was predictable of the model as it was
  int flips = 199;          ///< random signs, one of each group of strokes, that make the null
  std::size_t groups = 16;  ///< of strokes, at most; pieces of strokes if there are fewer strokes
};

/// What functions of the measured signals can say, on strokes left out, of the error that a model leaves. If
/// they can say nothing, no law of these signals is missing, whatever the colour of the sensor noise.
struct Predictability {
  bool tested = false;    ///< false: too few spans, or the model was not solved
  double share = 0;       ///< largest share of the error's energy that a bank predicts on groups left out
  double p_value = 1;     ///< of that share, among those of residuals with random signs
  double null_share = 0;  ///< 95 % of those are smaller: what could have been seen
  std::string about;      ///< what the bank is a function of
  double energy = 0;      ///< of the error on groups left out, mean per equation, output unit squared
  /// By how much scores of features scatter more between groups than white noise would let them.
  double correlation = 1;
  /// Whether a law is missing, on top of a model of which `before` (energy of the same equations) was predictable.
  bool IsStructured(const PredictabilityOptions& options, double predictable_before = 0) const {
    return tested && p_value <= options.max_p && share >= options.min_share &&
           share * energy >= options.of_base * predictable_before;
  }
  double predictable() const { return share * energy; }
  /// What cannot be predicted, mean per equation: sensor noise of any colour.
  double left() const { return (1 - share) * energy; }
};

/// The test for several fits of one model at once. Per bank of features (diagnosis/remainder/feature_banks.h) a ridge
/// regression of the residual, the model's own regressors beside it unpenalised, is fitted with each group of
/// strokes left out in turn; the best bank and penalty count. The null flips the sign of the residual group
/// by group, which keeps its spectrum, and takes the best bank and penalty likewise (Winkler et al. 2014,
/// sign flipping with a maximum statistic).
std::vector<Predictability> PredictabilityOf(const ModelStructure& model,
                                             std::span<const StrokeStretches> strokes,
                                             const WindowSamples& window,
                                             std::span<const ExtendedFit* const> fits,
                                             const PredictabilityOptions& options = {});

}  // namespace hydroscope
