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

/// Episodes cut into runs of so many readings (which may be means over several rows); each begins at the row where the one
/// before ends. What is not twice as long stays whole. Empty where nothing is cut.
std::vector<Episode> ShortRuns(std::span<const Episode> episodes, int readings);

/// Whether a run of the model may begin at any row: no initial state is that of an episode's beginning, and nothing reads what
/// an input was before.
bool BeginsAnywhere(const Machine& machine);

/// At most so many of the episodes, spread over them, in their order.
std::vector<std::size_t> SpreadOver(std::size_t episodes, std::size_t most);
std::vector<Episode> Chosen(std::span<const Episode> episodes, const std::vector<std::size_t>& chosen);

}  // namespace hydroscope
