#include "diagnosis/states/search_sentences.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/contains.h"
#include "core/short_number.h"

namespace hydroscope {

Told CannotBeTried(const std::string& effect, const Told& why) {
  return Tell("{} cannot be tried: {}", "{} lässt sich nicht versuchen: {}", effect, why);
}

Told MoreIsMissing(const StateRemainder& left, double unexplained) {
  return Tell(
      "functions of states and inputs still predict at least {:.0f} % of the error, most of it in the equation of {}: "
      "{:.2g} % of what they could predict before; a small law more is missing, or one of these differs a little",
      "Funktionen von Zuständen und Eingängen sagen noch mindestens {:.0f} % des Fehlers voraus, das meiste davon in der "
      "Gleichung von {}: {:.2g} % dessen, was sie vorher voraussagten; ein kleines Gesetz fehlt noch, oder eines von diesen "
      "ist etwas anders",
      100 * left.least_share, left.about, 100 * unexplained);
}

Told BurstsText(const ErrorBursts& bursts) {
  return Tell(
      "what is left is no white noise, and it comes in bursts, most between {} and {} s: noise of one strength does not. A law "
      "that acts seldom may be missing, or a disturbance is not measured. Look at these times in the measured signals",
      "was bleibt, ist kein weißes Rauschen und kommt in Stößen, am stärksten zwischen {} und {} s: Rauschen von einer Stärke "
      "tut das nicht. Es kann ein Gesetz fehlen, das selten wirkt, oder eine Störung wird nicht gemessen. Die gemessenen "
      "Signale zu diesen Zeiten ansehen",
      ShortNumber(bursts.from, 4), ShortNumber(bursts.to, 4));
}

Told MayBeMissing(const StateRemainder& left) {
  if (!left.doubtful && left.bursts) return BurstsText(*left.bursts);
  if (!left.doubtful)
    return Tell(
        "what is left is no white noise, and this log holds so little that chance predicts {:.0f} % of it: a law may be missing. "
        "Record for longer, where sensors do not end",
        "was bleibt, ist kein weißes Rauschen, und diese Aufzeichnung enthält so wenig, dass der Zufall {:.0f} % davon voraussagt: "
        "es kann ein Gesetz fehlen. Länger aufzeichnen, wo Sensoren nicht enden",
        100 * left.null_share);
  const double share =
      left.least_share >= StateRemainderOptions().doubt_share ? left.least_share : left.share;
  return Tell(
      "what is left is no white noise, and functions of {} predict {:.0f} % of it, as chance does in {:.0f} of a hundred logs: "
      "a law may be missing that this log shows too seldom, or noise acts on the process itself. Record for longer",
      "was bleibt, ist kein weißes Rauschen, und Funktionen von {} sagen {:.0f} % davon voraus, wie der Zufall in {:.0f} von "
      "hundert Aufzeichnungen: es kann ein Gesetz fehlen, das diese Aufzeichnung zu selten zeigt, oder Rauschen wirkt auf den "
      "Prozess selbst. Länger aufzeichnen",
      left.about, 100 * share, 100 * left.p_value);
}

Told MoreIsSlow(double share) {
  return Tell(
      "what is left lasts over many rows, and its energy is {:.2g} times that of what this explains: dynamics may be missing (a "
      "lag, a further mode), noise acts on the process itself, or a disturbance is not measured",
      "was bleibt, dauert über viele Zeilen, und seine Energie ist das {:.2g}fache dessen, was dies erklärt: Dynamik kann fehlen "
      "(eine Verzögerung, eine weitere Eigenform), Rauschen wirkt auf den Prozess selbst, oder eine Störung wird nicht gemessen",
      share);
}

Told InPlaceOf(const std::vector<std::string>& set, const std::vector<std::string>& other) {
  const auto alone = [](std::vector<std::string> ids, const std::vector<std::string>& but) {
    std::erase_if(ids, [&](const std::string& id) { return Contains(but, id); });
    return fmt::format("{}", fmt::join(ids, ", "));
  };
  return Tell("{} in place of {}", "{} anstelle von {}", alone(set, other), alone(other, set));
}

Told NotToldFrom(const Told& effect, const LikeFunction& like) {
  return Tell(
      "{} would explain a part of the error that is smaller than its noise; a function of {} in the equation of {} that is "
      "no effect of the machine file explains as much. To tell them apart, excite the machine more strongly or record for "
      "longer",
      "{} würde einen Teil des Fehlers erklären, der kleiner ist als sein Rauschen; eine Funktion von {} in der Gleichung "
      "von {}, die kein Effekt der Maschinendatei ist, erklärt ebenso viel. Um sie zu trennen, die Maschine stärker anregen "
      "oder länger aufzeichnen",
      effect, like.about, like.equation);
}

Told NotToldFromGeneral(const std::string& effect, const GeneralLaw& law) {
  return Tell(
      "{} in the equation of {}, which is no effect of the machine file, explains more than {} does: the law may be another. Give "
      "the file all laws that may be, excite the machine more strongly, or record for longer",
      "{} in der Gleichung von {}, kein Effekt der Maschinendatei, erklärt mehr als {}: das Gesetz kann ein anderes sein. Der "
      "Datei alle Gesetze geben, die es sein können, die Maschine stärker anregen oder länger aufzeichnen",
      law.formula, fmt::format("{}", fmt::join(law.equations, ", ")), effect);
}

Told MoreThanForeseen(const GeneralLaw& law, double share) {
  return Tell(
      "put beside what was found, {} in the equation of {}, which is no effect of the machine file, explains {:.2g} % of what both "
      "explain: what was found may imitate a law that is missing. Give the file all laws that may be",
      "neben das Gefundene gestellt, erklärt {} in der Gleichung von {}, kein Effekt der Maschinendatei, {:.2g} % dessen, was beide "
      "erklären: das Gefundene kann ein fehlendes Gesetz nachahmen. Der Datei alle Gesetze geben, die es sein können",
      law.formula, fmt::format("{}", fmt::join(law.equations, ", ")), 100 * share);
}

Told MayStandIn(const std::string& effect, double share) {
  return Tell(
      "{} would explain a further part of the error, but functions of states and inputs still predict as much as {:.0f} % of it: "
      "a law that is not in the machine file may be what it stands in for",
      "{} würde einen weiteren Teil des Fehlers erklären, doch Funktionen von Zuständen und Eingängen sagen noch so viel wie "
      "{:.0f} % davon voraus: es kann für ein Gesetz stehen, das nicht in der Maschinendatei ist",
      effect, 100 * share);
}

}  // namespace hydroscope
