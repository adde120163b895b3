#pragma once

#include <string>

#include "core/told.h"

namespace hydroscope {

/// What became of a valve check, as it is stored, in English, and told, in both languages. What a stored sentence
/// goes on with (the reason of an error) stays English.
namespace valve_check {

inline constexpr Wording kBusy{
    "the controller refused: the machine is working or another sweep runs",
    "die Steuerung lehnte ab: die Maschine arbeitet, oder ein anderer Sweep läuft"};
inline constexpr Wording kNotAllowed{"the controller refused: it does not allow this axis or amplitude",
                                     "die Steuerung lehnte ab: sie erlaubt diese Achse oder Amplitude nicht"};
inline constexpr Wording kBrokenOff{"the controller broke the sweep off; the machine began to work",
                                    "die Steuerung brach den Sweep ab; die Maschine begann zu arbeiten"};
inline constexpr Wording kNoAnswer{"the controller did not answer the request in time",
                                   "die Steuerung antwortete nicht rechtzeitig"};
inline constexpr Wording kTellsNothing{"the sweep ran, but its record tells nothing",
                                       "der Sweep lief, aber seine Aufzeichnung sagt nichts"};
inline constexpr Wording kNoModel{"the sweep ran, but no model fits its record",
                                  "der Sweep lief, aber kein Modell passt zu seiner Aufzeichnung"};

/// "16 frequencies, 16.4 s recorded", and where harmonics are notable (share of the fundamental, else 0) how large.
Told Measured(std::size_t frequencies, double seconds, double harmonics);

/// A stored sentence in both languages; of one that is not of these English alone.
Told ToldOf(const std::string& detail);

}  // namespace valve_check
}  // namespace hydroscope
