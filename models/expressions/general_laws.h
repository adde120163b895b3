#pragma once

#include <memory>
#include <vector>

#include "models/effect.h"

namespace hydroscope {

/// Laws without a name (Effect::generic) of a balance of the user's own: the first powers and roots of `channels`, which its
/// terms and effects read, products of two of them, and the rates of `late`: a signal that comes later than the others, or
/// through a filter, leaves an error that goes with its rate. Their titles are expressions. They tell whether an effect of the
/// machine file is no more than the nearest to a law that nobody wrote down, and what may be missing where none fits.
std::vector<std::shared_ptr<const Effect>> GeneralLaws(const ModelStructure& model,
                                                       const std::vector<int>& channels,
                                                       const std::vector<int>& late);

}  // namespace hydroscope
