#include "workbench/states/states_warnings.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "core/short_number.h"
#include "diagnosis/states/search_sentences.h"
#include "estimation/states/unseen_ripple.h"
#include "models/machine_kind.h"

namespace hydroscope {
namespace {

/// Of a free run that hardly follows what was measured.
Told AstrayText(const StateFit& fit) {
  return Tell(
      "the free run errs by {:.0f} % of the variation of what was measured, though the next row is foreseen better: it "
      "stands in a wrong minimum, loses its way over so long an episode, or noise acts on the process itself. Narrow the "
      "ranges in [parameters], or cut the log with [episodes] seconds",
      "der freie Lauf weicht um {:.0f} % der gemessenen Schwankung ab, obwohl die nächste Zeile besser vorausgesagt "
      "wird: er steht in einem falschen Minimum, verliert sich über so lange Episoden, oder Rauschen wirkt auf den Prozess "
      "selbst. Die Bereiche in [parameters] enger fassen oder die Aufzeichnung mit [episodes] seconds teilen",
      100 * fit.ErrorOfVariation());
}

/// "k1 up by 1 % with A1 up by 1 %".
Told UnseenText(const UnseenDirection& unseen) {
  if (unseen.parts.size() == 1)
    return Tell("nothing in these data depends on {}", "nichts in diesen Daten hängt von {} ab",
                unseen.parts.front().first);
  const double sign = unseen.parts.front().second < 0 ? -1 : 1;
  Told parts;
  for (const auto& [name, share] : unseen.parts) {
    const Told moved = sign * share > 0 ? Tell("up", "mehr") : Tell("down", "weniger");
    const Told part = Tell("{} {} by {:.2g} %", "{0} um {2:.2g} % {1}", name, moved, std::abs(share));
    parts = parts.empty() ? part : Tell("{} with {}", "{} mit {}", parts, part);
  }
  return Tell("the data do not see {}: nothing that is measured changes",
              "die Daten sehen nicht: {}; nichts Gemessenes ändert sich", parts);
}

/// Of a parameter that acts by a ripple alone, in a record that has too little.
Told NoRippleText(const UnseenDirection& unseen) {
  return Tell(
      "{} acts by what repeats with the shaft alone, and this log holds too little of that to show it",
      "{} wirkt nur durch das, was sich mit der Welle wiederholt, und davon enthält diese Aufzeichnung zu wenig, um ihn zu zeigen",
      unseen.parts.front().first);
}

std::string PerCents(const std::vector<double>& shares) {
  std::vector<std::string> texts;
  for (const double share : shares) texts.push_back(ShortNumber(100 * share, 2));
  return fmt::format("{} %", fmt::join(texts, ", "));
}

/// Parameters that only another sensor tells from one another.
Told ToldTogetherText(const ToldTogether& together) {
  Told text = Tell("the data tell {} only together, each of them to {} (standard error)",
                   "die Daten zeigen {} nur zusammen, jeden davon auf {} (Standardfehler)",
                   fmt::to_string(fmt::join(together.parameters, ", ")), TellNumber(PerCents(together.std)));
  for (const MissingSensor& sensor : together.sensors)
    text = Tell("{}; with {} measured too, to 1 % of its variation, {}",
                "{}; wird auch {} gemessen, auf 1 % seiner Schwankung: {}", text, sensor.signal,
                TellNumber(PerCents(sensor.std)));
  return text;
}

/// Of an error that lasts over many rows and that nothing predicts.
Told SlowText(const Told& consequence) {
  return Tell(
      "the error is slow, yet no function of states and inputs predicts it: noise acts on the process itself, a "
      "disturbance is not measured, or a sensor lags{}",
      "der Fehler ist langsam, doch keine Funktion von Zuständen und Eingängen sagt ihn voraus: Rauschen wirkt auf den "
      "Prozess selbst, eine Störung wird nicht gemessen, oder ein Sensor hinkt nach{}",
      consequence);
}

}  // namespace

std::vector<Told> FitWarnings(const StatesFit& fit) {
  std::vector<Told> warnings = fit.log.warnings;
  bool vary = false;
  for (const UnseenDirection& unseen : fit.fit.unseen) {
    const bool ripple = OnlyRippleShows(*fit.fit.model, unseen);
    warnings.push_back(ripple ? NoRippleText(unseen) : UnseenText(unseen));
    vary = vary || !ripple;
  }
  if (!fit.told_together.parameters.empty()) warnings.push_back(ToldTogetherText(fit.told_together));
  if (vary)
    warnings.push_back(Tell("to see what these data do not, vary {}",
                            "um zu sehen, was diese Daten nicht zeigen, variieren: {}",
                            WordsOf(fit.log.machine).vary));
  for (std::size_t p = 0; p < fit.fit.at_limit.size(); ++p)
    if (fit.fit.at_limit[p])
      warnings.push_back(Tell(
          "{} stands at a limit of its range; widen it in the machine file if physics allows",
          "{} steht an einer Grenze seines Bereichs; ihn in der Maschinendatei erweitern, wenn die Physik es erlaubt",
          fit.parameters[p].parameter));
  if (fit.left.structured)
    warnings.push_back(Tell(
        "functions of states and inputs predict at least {:.0f} % of the error left out, most of it in the "
        "equation of {}: the model misses something, and its parameters absorb part of it and may lie outside their intervals",
        "Funktionen von Zuständen und Eingängen sagen mindestens {:.0f} % des ausgelassenen Fehlers voraus, das meiste davon in der "
        "Gleichung von {}: dem Modell fehlt etwas, und seine Parameter nehmen einen Teil davon auf und können außerhalb ihrer Intervalle liegen",
        100 * fit.left.least_share, fit.left.about));
  if (fit.doubted_limit) warnings.push_back(DoubtedLimitText(*fit.doubted_limit));
  if (fit.missing_limit) warnings.push_back(MissingLimitText(*fit.missing_limit, fit.log.machine, false));
  if (fit.dynamics) warnings.push_back(MissingDynamicsText(*fit.dynamics));
  if (fit.drift) warnings.push_back(ParameterDriftText(*fit.drift));
  if (fit.other_sampling) warnings.push_back(OtherSamplingText(*fit.other_sampling));
  if (fit.astray())
    warnings.push_back(AstrayText(fit.fit));
  else if (fit.may_lack_law())
    warnings.push_back(MayBeMissing(fit.left));
  else if (fit.slow() && !fit.drift && !fit.dynamics)
    warnings.push_back(SlowText(
        fit.prediction ? Tell("; the parameters are those that predict one row ahead best",
                              "; die Parameter sind die, die eine Zeile voraus am besten voraussagen")
                       : Tell(", and the intervals hold it", ", und die Intervalle enthalten es")));
  return warnings;
}

std::vector<Told> ExplainWarnings(const StatesExplained& e) {
  std::vector<Told> warnings = e.log.warnings;
  warnings.insert(warnings.end(), e.explanation.warnings.begin(), e.explanation.warnings.end());
  if (e.explanation.astray)
    warnings.push_back(AstrayText(e.explanation.final.fit));
  else if (e.slow())
    warnings.push_back(SlowText(Tell(
        "; a law may hide in it: look at the error in time with 'hydroscope compare'",
        "; ein Gesetz kann darin verborgen sein: den Fehler über der Zeit ansehen, mit 'hydroscope compare'")));
  return warnings;
}

}  // namespace hydroscope
