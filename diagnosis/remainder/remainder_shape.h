#pragma once

#include <optional>
#include <string>
#include <vector>

#include "diagnosis/remainder/locate.h"

namespace hydroscope {

struct ShapePoint {
  double x = 0;      ///< in the signal's unit as shown
  double value = 0;  ///< output unit, measured less modelled
  double std = 0;    ///< clustered by stroke; value +- 1.96 std is the pointwise 95 % band
};

/// What a model leaves, as a smooth curve over the one signal that it follows best.
struct RemainderShape {
  std::string signal, unit;
  /// Share of the error's energy that the curve predicts on strokes left out, at most 1.
  double explained = 0;
  std::vector<ShapePoint> points;
};

/// The curve a person may recognise: a penalised cubic B-spline of the flow residual (P-spline, Eilers and
/// Marx 1996) with the smoothness that predicts strokes left out best, and a band from leaving out one stroke
/// at a time. Signals compete by what their curve predicts on strokes left out. nullopt if the error follows
/// none of them by at least 5 %, or with fewer than three strokes.
std::optional<RemainderShape> ShapeOfRemainder(const Residuals& residuals);

}  // namespace hydroscope
