#pragma once

#include <cstdint>

#include "core/records/symmetric_matrix.h"

namespace hydroscope {

/// What one stroke leaves behind: the sums of products from which every later fit, ranking and interval is
/// computed. Columns are those of `models/model_structure.h`: base regressors, output, library regressors.
/// Sums of Grams over strokes are exact least squares over those strokes.
struct StrokeGram {
  std::int64_t blocks = 0;  ///< block means that entered `integral`
  std::int64_t spans = 0;   ///< spans, each of which spent one intercept; 0 in the level form, which has none
  std::int64_t windows = 0;  ///< flow windows that entered `flow`
  SymmetricMatrix integral;  ///< integrated output units: block means, each span about its own mean
  SymmetricMatrix noise;     ///< share of `integral` that is sensor noise, from odd minus even samples
  SymmetricMatrix flow;      ///< output units over the triangular window, not centred
  int log = 0;  ///< number of the log or run it is from, where several are taken together; not stored
};

}  // namespace hydroscope
