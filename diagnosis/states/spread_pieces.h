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

}  // namespace hydroscope
