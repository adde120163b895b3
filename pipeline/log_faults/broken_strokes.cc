#include "pipeline/log_faults/broken_strokes.h"

#include <algorithm>

namespace hydroscope {
namespace {

constexpr double kManyBad = 0.1;  ///< share of a signal's readings

}  // namespace

Told BrokenUp(std::span<const ChannelQuality> channels, const Machine& machine, std::int64_t strokes,
              std::int64_t discarded) {
  if (discarded <= strokes) return {};
  const ChannelQuality* worst = nullptr;
  double bad = 0;
  for (std::size_t s = 0; s < channels.size(); ++s) {
    if (!machine.signals[s].required || channels[s].rows == 0) continue;
    const auto most = static_cast<double>(std::ranges::max(channels[s].flagged));
    const double share = most / static_cast<double>(channels[s].rows);
    if (share > bad) bad = share, worst = &channels[s];
  }
  if (bad < kManyBad) return {};
  return Tell(
      "bad readings ({0:.0f} % of those of {1}) break up strokes into {2} pieces too short to use: the {3} strokes that are left do "
      "not speak for the log. 'hydroscope check' says what is wrong with {1}",
      "schlechte Werte ({0:.0f} % derer von {1}) zerreißen Hübe in {2} Stücke, die zu kurz sind: die {3} Hübe, die bleiben, sprechen "
      "nicht für die Aufzeichnung. Was mit {1} nicht stimmt, sagt 'hydroscope check'",
      100 * bad, worst->name, discarded, strokes);
}

}  // namespace hydroscope
