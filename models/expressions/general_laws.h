#pragma once

#include <memory>
#include <vector>

#include "models/effect.h"

namespace hydroscope {

/// Laws without a name (Effect::generic) of a balance of the user's own: the first powers and roots of `channels`, which its
/// terms and effects read, and products of two of them. They tell whether an effect of the machine file is no more than
/// the nearest to a law that nobody wrote down.
std::vector<std::shared_ptr<const Effect>> GeneralLaws(const ModelStructure& model,
                                                       const std::vector<int>& channels);

}  // namespace hydroscope
