#pragma once

#include <memory>
#include <vector>

#include "models/effect.h"

namespace hydroscope {

/// Laws without a name (Effect::generic) of a die cushion: the first powers and products of its signals, as a flow, a
/// flow gain or a volume.
std::vector<std::shared_ptr<const Effect>> CushionLaws();

}  // namespace hydroscope
