#pragma once

#include <Eigen/Core>
#include <span>
#include <string>

#include "diagnosis/explain.h"
#include "diagnosis/odd_strokes.h"

namespace hydroscope {

/// Parameters of the base model that explain odd strokes by other values in them.
struct ParameterInPlace {
  std::string by_one;  ///< the same other value in all of them; "" if no parameter does
  /// A value of its own in each of them, as a parameter has that follows the oil; "" if none does.
  std::string by_each;
};

/// Parameters that explain the strokes `odd` about as well as the effects of `found` do and down to the floor, or, if these explain
/// nothing, down to the floor. The rest of the strokes has the model `rest`.
ParameterInPlace ParameterInPlaceOf(const Explanation& found, bool explains, const StrokeSet& odd,
                                    const ExtendedFit& rest, const ExplainOptions& explain,
                                    const OddStrokeOptions& options);

/// How the base model's coefficients move with each of the parameters alone, a column each over all columns of the model.
Eigen::MatrixXd MovesOf(const ModelStructure& model, std::span<const DerivedParameter> derived);

}  // namespace hydroscope
