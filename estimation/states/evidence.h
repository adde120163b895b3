#pragma once

#include "estimation/states/fit.h"
#include "estimation/states/shooting.h"

namespace hydroscope {

/// StateFit::pieces: information, gradient and energy of pieces of the rows, initial states taken out.
void TakePieces(const shooting::Task& task, const StateFitOptions& options, StateFit& fit);

/// StateFit::covariance and unseen. Intervals from the residuals as they are: pieces of the log are left out in turn (MacKinnon
/// and White 1985), with Student's t where few of them tell of a parameter. Directions of the parameters, each over its size, that change no output beyond what is left are unseen.
void TakeCovariance(const shooting::Task& task, StateFit& fit);

}  // namespace hydroscope
