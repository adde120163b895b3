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

/// matrix = 1 - own weight of an implicit stage * step * df/dx, n x n, row by row; states that are held do not move.
void PutStageMatrix(const std::vector<TangentEntries::Entry>& by_states, const double* registers,
                    const unsigned char* held, double step, std::size_t n, double* matrix);

/// An explicit step differentiated: from s to `end`, by way of the rates k of each stage. `stages`: all but the last.
void DifferentiateStep(const TangentShape& shape, const TangentPoint* stages, double step, const double* s,
                       double* k, double* end);

/// An implicit step differentiated, as DifferentiateStep.
void DifferentiateImplicitStep(const TangentShape& shape, const TangentPoint* stages, double step,
                               const double* s, double* k, double* end);

}  // namespace hydroscope
