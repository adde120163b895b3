#include "workbench/states/states_words.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/short_number.h"
#include "models/output_unit.h"
#include "models/state_effects.h"

namespace hydroscope {

ErrorWords ErrorWordsOf(const StatesError& error) {
  if (error.of_variation) return {kOfVariation.factor, std::string(kOfVariation.name)};
  return {1, std::string(error.unit.name == "1" ? "a number" : error.unit.name)};
}

std::string ErrorText(const StatesError& error, double value) {
  const ErrorWords words = ErrorWordsOf(error);
  if (error.unit.name == "1" && !error.of_variation) return ShortNumber(value);
  return ShortNumber(value * words.factor) + " " + words.unit;
}

double ShownLeftOut(const StatesExplained& e, const StateCandidate& candidate) {
  const StatesExplanation& x = e.explanation;
  if (candidate.added == x.final.added) return e.final.rms_holdout;
  if (candidate.fitted()) return e.base.unit.factor * x.scale_of_tried * ErrorLeftOut(candidate.fit);
  return e.base.rms_holdout * std::sqrt(candidate.held_out / std::max(x.base.held_out, 1e-300));
}

const char* NoiseWords(bool alone) { return alone ? "noise alone" : "noise at most"; }

std::string NamedEffect(const std::vector<Effect>& effects, const std::string& id) {
  const Effect* effect = FindStateEffect(effects, id);
  return effect == nullptr || effect->title == id ? id : fmt::format("{} ({})", effect->title, id);
}

std::string PlainWords(const std::vector<Effect>& effects, const std::string& id) {
  const Effect* effect = FindStateEffect(effects, id);
  return effect == nullptr ? "" : effect->plain;
}

Told WhyNotSeen(const StatesExplanation& x, const std::string& id) {
  const auto found = x.not_seen.find(id);
  if (found == x.not_seen.end()) return {};
  return found->second == EffectSeen::kNeverActs
             ? Tell(
                   "wherever it lies in its range, the outputs hardly change: the machine was not driven to where it acts",
                   "wo immer er in seinem Bereich liegt, ändern sich die Ausgänge kaum: die Maschine kam nicht dorthin, wo er "
                   "wirkt")
             : Tell("what it does to the outputs the parameters take over",
                    "was er an den Ausgängen ändert, übernehmen die Parameter");
}

Told ZerosToRead(const MissingZeros& zeros, const Machine& machine) {
  Told text;
  for (const MissingZeros::Zero& zero : zeros.of) {
    const DisplayUnit unit = ShownUnit(machine, zero.signal);
    const Told one = Tell(
        "Read {0} where its true value is known: if it is {1:+.4g} {2} off there too, that is the zero of its sensor, to be set or "
        "to be added to {0} in [outputs].",
        "{0} ablesen, wo der wahre Wert bekannt ist: ist es auch dort um {1:+.4g} {2} daneben, ist das der Nullpunkt des Sensors, "
        "der einzustellen oder unter [outputs] zu {0} zu addieren ist.",
        zero.signal, zero.at * unit.factor, std::string(unit.name));
    text = text.empty() ? one : Tell("{} {}", "{} {}", text, one);
  }
  return text;
}

}  // namespace hydroscope
