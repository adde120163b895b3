#pragma once

#include <memory>
#include <span>

#include "diagnosis/extended_fit.h"
#include "models/stretch.h"

namespace hydroscope {

/// A nonlinear parameter that was found from the same strokes scatters, and with it the parameters of a fit
/// that takes it as given. Replaces covariance and effects' std of `fit` (of base + `choices` on these
/// strokes) by those that hold it free, to first order:
/// - free parameters: an effect at shifted values is the effect and its slope, so in a fit with both shapes
///   the sum of the two sizes is the size;
/// - parameters eta that a law ties to theta, eta = g(theta) (Effect::implied): with D = d theta / d eta of
///   the fit at given eta, an error e of theta at given eta becomes (I - D g')^-1 e (implicit function
///   theorem).
/// - parameters known beforehand (NonlinearParameter::std) and constants of laws (UncertainConstant): D times what
///   is known of them, the former where the strokes do not know better.
/// Fills EffectEstimate::nonlinear_std. Leaves `fit` as it is where the strokes do not determine the wider fit.
void WidenByNonlinear(std::shared_ptr<const ModelStructure> model, std::span<const StrokeStretches> strokes,
                      const WindowSamples& window, std::span<const EffectChoice> choices, ExtendedFit& fit);

}  // namespace hydroscope
