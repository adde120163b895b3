#include "storage/valve_check_words.h"

#include <cstdio>

namespace hydroscope::valve_check {

Told Measured(std::size_t frequencies, double seconds, double harmonics) {
  const Told measured = Tell("{} frequencies, {:.1f} s recorded", "{} Frequenzen, {:.1f} s aufgezeichnet",
                             frequencies, seconds);
  if (harmonics == 0) return measured;
  return Tell(
      "{}; up to {:.1f} % harmonics that the command does not have (limit, dead band or play): gain and "
      "frequency hold for this amplitude only",
      "{}; bis {:.1f} % Oberschwingungen, die der Befehl nicht hat (Anschlag, Totband oder Spiel): Verstärkung und "
      "Frequenz gelten nur für diese Amplitude",
      measured, 100 * harmonics);
}

Told ToldOf(const std::string& detail) {
  for (const Wording& known : {kBusy, kNotAllowed, kBrokenOff, kNoAnswer, kTellsNothing, kNoModel})
    if (detail.starts_with(known.english))
      return {detail, std::string(known.german) + detail.substr(known.english.size())};
  std::size_t frequencies = 0;
  double seconds = 0, percent = 0;
  if (std::sscanf(detail.c_str(), "%zu frequencies, %lf s recorded; up to %lf", &frequencies, &seconds,
                  &percent) < 2)
    return detail;
  return {detail, Measured(frequencies, seconds, percent / 100).german};
}

}  // namespace hydroscope::valve_check
