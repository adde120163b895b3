#pragma once

#include <span>
#include <string>
#include <vector>

#include "estimation/states/fit.h"
#include "estimation/states/shooting.h"

/// What a fit of a model with states begins with: the rows, their scales, its starts.
namespace hydroscope::shooting {

/// Standard deviation of each output in the data.
Eigen::VectorXd OutputScale(const StateModel& model, std::span<const Episode> episodes);

/// Weights are a share of the outputs' variation until a fit knows their noise.
Task TaskOf(std::shared_ptr<const StateModel> model, std::span<const Episode> episodes);

/// Parameters, SI, as the optimiser sees them; initial states are not guessed.
Point PointAt(const Task& task, const Eigen::VectorXd& parameters);

/// The first rows of the episodes, `rows` in all; whole episodes where they fit.
std::vector<Episode> FirstRows(std::span<const Episode> episodes, int rows);

/// Starts: that of the machine file, then draws from the ranges; `near`: the first of them close to it, each further away.
std::vector<Eigen::VectorXd> StartsOf(const Task& task, const StateFitOptions& options, bool near = false);

/// Whether two starts differ by a quarter of a parameter's range: from close by the same minimum says nothing of others. True where
/// no parameter has a range, for then there is no other start.
bool FarApart(const ParameterScale& scale, const Eigen::VectorXd& a, const Eigen::VectorXd& b);

/// Whether starts of the same cost ended in one minimum: no parameter differs by a tenth of its range.
bool SameEnd(const ParameterScale& scale, const Eigen::VectorXd& a, const Eigen::VectorXd& b);

/// Where a model that diverges does so, a sentence.
Told DivergedText(const Task& task, const Eigen::VectorXd& theta);

}  // namespace hydroscope::shooting
