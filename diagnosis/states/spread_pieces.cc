#include "diagnosis/states/spread_pieces.h"

#include <algorithm>
#include <cmath>

#include "models/state_effects.h"
#include "models/state_model.h"

namespace hydroscope {
namespace {

/// Whether an equation or effect reads what an input was before, which a piece of an episode does not know.
bool ReadsThePast(const Machine& machine) {
  const auto delays = [&](const std::vector<std::string>& effects) {
    const auto model = BuildStateModel(machine, effects);
    return model && !(*model)->delays.empty();
  };
  const std::vector<Effect> effects = StateEffectsOf(machine);
  return delays(machine.added_effects) ||
         std::any_of(effects.begin(), effects.end(),
                     [&](const Effect& effect) { return delays({effect.id}); });
}

}  // namespace

std::vector<Episode> SpreadPieces(const Machine& machine, std::span<const Episode> episodes, int most_rows,
                                  int piece_rows) {
  std::int64_t rows = 0;
  for (const Episode& episode : episodes) rows += episode.rows();
  std::vector<Episode> pieces;
  if (rows <= most_rows || ReadsThePast(machine)) return pieces;
  const auto apart = static_cast<std::int64_t>(std::ceil(static_cast<double>(rows) * piece_rows / most_rows));
  for (const Episode& episode : episodes) {
    // Readings that are means end where they did.
    const std::int64_t step = (apart + episode.mean_rows - 1) / episode.mean_rows * episode.mean_rows;
    for (std::int64_t first = 0; first < episode.rows(); first += step) {
      const std::int64_t count = std::min<std::int64_t>(piece_rows, episode.rows() - first);
      if (count < piece_rows && first > 0) break;
      pieces.push_back({episode.log,
                        episode.first_row + first,
                        {episode.time.begin() + first, episode.time.begin() + first + count},
                        episode.signal.middleRows(first, count),
                        episode.mean_rows});
    }
  }
  return pieces;
}

}  // namespace hydroscope
