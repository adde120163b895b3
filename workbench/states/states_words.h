#pragma once

#include <string>
#include <vector>

#include "core/told.h"
#include "models/effect.h"
#include "workbench/states/states_log.h"

namespace hydroscope {

// How text, JSON and page call the figures and effects of a machine with states.

/// What errors are told in; of several outputs as a share.
struct ErrorWords {
  double factor;
  std::string unit;
};
ErrorWords ErrorWordsOf(const StatesError& error);
/// "0.0118 V", of an error as StatesError has it.
std::string ErrorText(const StatesError& error, double value);

/// What functions of states and inputs do not predict need not be noise as long as they predict something.
const char* NoiseWords(bool alone);

/// "Air in the oil (air)"; effects of users' own are called by what their file calls them.
std::string NamedEffect(const std::vector<Effect>& effects, const std::string& id);

/// StatesError::rms_holdout of a set of effects; of one that was not fitted as linearisation foresees it.
double ShownLeftOut(const StatesExplained& e, const StateCandidate& candidate);

/// Why these episodes cannot show an effect; empty: they can.
Told WhyNotSeen(const StatesExplanation& x, const std::string& id);

/// Of a log that the model describes but for constants (StatesExplained::only_zeros).
inline constexpr Wording kOnlyZeros = {
    "But for a constant that the machine file lacks, see the warning, the model describes these episodes: the zero of a sensor, or "
    "a law; the log does not tell which.",
    "Bis auf eine Konstante, die in der Maschinendatei fehlt (siehe Warnung), beschreibt das Modell diese Episoden: der Nullpunkt "
    "eines Sensors oder ein Gesetz; das Log sagt nicht, welches."};

/// What to do about constants: a reading at a known value tells whether they are zeros of sensors.
Told ZerosToRead(const MissingZeros& zeros, const Machine& machine);

/// What an effect of a built-in machine means for the plant; "" of those of the machine file.
std::string PlainWords(const std::vector<Effect>& effects, const std::string& id);

}  // namespace hydroscope
