#pragma once

#include <span>
#include <vector>

#include "estimation/states/fit.h"

namespace hydroscope {

/// What the outputs of an episode of a fit would change by, each over its noise: columns of the parameters, then of the added
/// terms, last `errors` (row x output; NaN without a reading). What the episode's initial states explain is projected out of
/// all. Rows are (row, output); those without a reading are 0, and so are columns of parameters at a limit of their range.
RowMatrix TangentColumns(const StateFit& fit, const Episode& episode, std::size_t index,
                         const AddedTerms& added, const std::vector<const RowMatrix*>& errors);

/// Products of these columns, of all episodes (`errors`: each per episode), by piece of the fit.
std::vector<Eigen::MatrixXd> PieceProducts(const StateFit& fit, std::span<const Episode> episodes,
                                           const AddedTerms& added,
                                           const std::vector<const std::vector<RowMatrix>*>& errors);

}  // namespace hydroscope
