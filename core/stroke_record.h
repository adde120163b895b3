#pragma once

#include <vector>

#include "core/records.h"
#include "core/stroke_gram.h"

namespace hydroscope {

/// Everything the pipeline says at the end of one stroke, and what is stored of it.
struct StrokeRecord {
  StrokeSummary summary;
  StrokeGram gram;
  std::vector<Estimate> estimates;  ///< one per parameter of the model
};

}  // namespace hydroscope
