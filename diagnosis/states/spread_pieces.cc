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

std::vector<Episode> ShortRuns(std::span<const Episode> episodes, int readings) {
  std::vector<Episode> runs;
  bool cut = false;
  for (const Episode& episode : episodes) {
    const std::int64_t rows = episode.rows(),
                       length = static_cast<std::int64_t>(readings) * episode.mean_rows;
    if (rows <= 2 * length) {
      runs.push_back(episode);
      continue;
    }
    cut = true;
    for (std::int64_t first = 0; first + 1 < rows; first += length) {
      const bool last = rows - 1 - first < 2 * length;
      runs.push_back(episode.Part(first, last ? rows - first : length + 1));
      if (last) break;
    }
  }
  return cut ? runs : std::vector<Episode>();
}

bool BeginsAnywhere(const Machine& machine) {
  const auto model = BuildStateModel(machine, machine.added_effects);
  return model &&
         std::all_of((*model)->estimated.begin(), (*model)->estimated.end(), [](bool e) { return e; }) &&
         !ReadsThePast(machine);
}

std::vector<std::size_t> SpreadOver(std::size_t episodes, std::size_t most) {
  const std::size_t count = std::min(episodes, std::max<std::size_t>(1, most));
  std::vector<std::size_t> chosen;
  for (std::size_t k = 0; k < count; ++k) chosen.push_back((2 * k + 1) * episodes / (2 * count));
  return chosen;
}

std::vector<Episode> Chosen(std::span<const Episode> episodes, const std::vector<std::size_t>& chosen) {
  std::vector<Episode> out;
  for (const std::size_t e : chosen) out.push_back(episodes[e]);
  return out;
}

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
      pieces.push_back(episode.Part(first, count));
    }
  }
  return pieces;
}

}  // namespace hydroscope
