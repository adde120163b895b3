#pragma once

#include "estimation/states/fit.h"
#include "estimation/states/shooting.h"

namespace hydroscope {

/// Whether so many outputs are measured that Gauss and Newton's steps go the right way from far off, and normal equations lose no
/// digit that matters.
bool SeesMuch(const StateModel& model);
/// Whether a model is fitted over a growing horizon: several outputs, or what the file says they lie near, tell
/// the states from a few rows on.
bool GrowsHorizon(const StateModel& model);

/// Standard deviation of the white noise of each output from its third differences, at most `largest` of it: what moves evenly
/// over four rows leaves nothing in them.
Eigen::VectorXd WhiteNoise(const StateModel& model, std::span<const Episode> episodes,
                           const Eigen::VectorXd& largest);

/// Output error over a growing horizon: free runs over the first rows of each episode, then twice as many, and so on to the
/// end, by Levenberg and Marquardt's method on normal equations, no step longer than e of a parameter (1 on its scale). Free
/// runs from far off go astray over a whole record, but not over its first rows. Not valid where the model diverges.
shooting::Point FitGrowing(const shooting::Task& task, const Eigen::VectorXd& start,
                           const StateFitOptions& options);

/// The same from a point that was fitted to the first `rows` rows of each episode; the point itself where runs from it err hardly
/// more over all rows.
shooting::Point GrowFrom(const shooting::Task& task, const shooting::Point& few, int rows,
                         const StateFitOptions& options);

/// By the same method over all rows at once from a point near the minimum, to less than a tenth of a standard deviation where outputs are
/// weighted by their noise. False if the model diverges there.
bool PolishWhole(const shooting::Task& task, const StateFitOptions& options, shooting::Point& point);

}  // namespace hydroscope
