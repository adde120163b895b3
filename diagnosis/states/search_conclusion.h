#pragma once

#include "diagnosis/states/found_sets.h"

namespace hydroscope {

/// The verdict of a search for missing effects: whether the set found explains all, which of its effects are named, what else may be
/// missing, which sets do as well. Writes into `found.out`.
void ConcludeSearch(FoundSets& found);

/// Adds what was said of whole episodes to what short runs tell, unless these say it too.
void AddOverWhole(std::span<const Told> of_whole, std::vector<Told>& told);

}  // namespace hydroscope
