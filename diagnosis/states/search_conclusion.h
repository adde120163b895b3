#pragma once

#include "diagnosis/states/found_sets.h"

namespace hydroscope {

/// The verdict of a search for missing effects: whether the set found explains all, which of its effects are named, what else may be
/// missing, which sets do as well. Writes into `found.out`.
void ConcludeSearch(FoundSets& found);

}  // namespace hydroscope
