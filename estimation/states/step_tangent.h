#pragma once

#include <cstddef>
#include <vector>

#include "estimation/states/simulation.h"

namespace hydroscope {

/// Shapes of the sensitivities, row by row of the states.
struct TangentShape {
  const TangentEntries& entries;
  int states, columns;      ///< columns: a multiple of kSensitivityPadding
  const AddedTerms* terms;  ///< nullptr: none
  int terms_from;           ///< column
};

/// The equations at a point, as their tangent needs them.
struct TangentPoint {
  const double* registers;    ///< that hold the values of the entries
  const unsigned char* held;  ///< per state
  const double* added;        ///< values of the added terms
};

/// out = J s + df/dp + what added terms give.
void RateOfSlopes(const TangentShape& shape, const TangentPoint& point, const double* s, double* out);

/// An explicit step differentiated: from s to `end`, by way of the rates k of each stage. `stages`: all but the last.
void DifferentiateStep(const TangentShape& shape, const TangentPoint* stages, double step, const double* s,
                       double* k, double* end);

}  // namespace hydroscope
