#pragma once

#include <vector>

#include "estimation/frequency_response/frequency_response.h"

namespace hydroscope {

/// Fits the second-order model with dead time to the points marked kUsed.
///
/// Starting values: the linear equation of the squared gain,
///   |G|^2 = theta_1 w^2 |G|^2 - theta_2 w^4 |G|^2 + theta_3,
///   theta_1 = (2 - 4 D^2)/w0^2, theta_2 = 1/w0^4, theta_3 = K_v^2
/// (die-cushion paper, eq. 18-21), each row divided by the standard deviation of its |G|^2, and a coarse grid
/// of f0 and D. Then Levenberg-Marquardt (Ceres) on the complex response, every point weighted by its variance: gain
/// and phase count together. Covariance from the Jacobian, times `correlation` (neighbouring Welch bins share
/// information), times chi^2/dof if the misfit exceeds the noise at the 95 % level; with few degrees of
/// freedom the std is widened by Student's t. Derived figures by the delta method.
///
/// A response without any sign of a second pole lets D grow without bound; it is then held at 5
/// (`first_order`): f0 and D come with the wide intervals they deserve, bandwidth and gain with narrow ones.
///
/// With a `sample_period` (s) a misfit beyond the noise is tried once more with a command that is held from
/// sample to sample, as a controller that logs its own output does; it is taken if chi^2 falls below a
/// quarter (`command_hold`), and always if the command is `surely_held`. Without it the hold would pass for half a
/// sample of dead time and a lower f0.
///
/// With a model `near` of nearly the same points the search starts there and not from the grid.
///
/// Error (kBadInput): fewer than three points, or the points do not determine the model.
Result<ValveModel> FitValveModel(const std::vector<FrequencyPoint>& points, double correlation = 1,
                                 double sample_period = 0, bool surely_held = false,
                                 const ValveModel* near = nullptr);

/// Adds multiples of 2 pi to the points' phases: continuous over frequency, starting within +-pi; nearest to
/// the model's phase if there is one. Points must be in order of frequency.
void UnwrapPhases(std::vector<FrequencyPoint>& points, const ValveModel* model = nullptr);

}  // namespace hydroscope
