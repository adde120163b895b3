#pragma once

#include <span>
#include <vector>

#include "estimation/states/simulation.h"
#include "models/machine.h"

namespace hydroscope {

/// Pieces of `piece_rows` rows spread over episodes of more than `most_rows` rows, which are too many to try everything on all
/// of them; empty where they are not too many, or where an equation or effect reads what an input was before, which a piece
/// does not know.
std::vector<Episode> SpreadPieces(const Machine& machine, std::span<const Episode> episodes, int most_rows,
                                  int piece_rows);

/// Episodes whose readings are means, cut into runs of `readings` of them; each begins at the row where the one before ends. Other
/// episodes stay whole. Empty where nothing is cut.
std::vector<Episode> ShortRuns(std::span<const Episode> episodes, int readings);

/// At most so many of the episodes, spread over them, in their order.
std::vector<std::size_t> SpreadOver(std::size_t episodes, int most);
std::vector<Episode> Chosen(std::span<const Episode> episodes, const std::vector<std::size_t>& chosen);

}  // namespace hydroscope
