#include "workbench/explain/headline.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "diagnosis/doubts.h"

namespace hydroscope {
namespace {

/// Error on strokes left out over that on the strokes of the fit from which the fit hangs on single strokes.
/// Leaving one of n strokes out raises it by some 1 + p/n per parameter and stroke: 1.5 at the fewest strokes
/// that are fitted.
constexpr double kUnstable = 3.0;

bool IsNumber(double x) { return std::isfinite(x) && x >= 0; }

}  // namespace

Told ImpossibleFigures(const GramFit& f) {
  for (const double x : {f.rms_measured, f.rms_modelled, f.rms_residual, f.rms_holdout, f.noise_floor})
    if (!IsNumber(x))
      return Tell(
          "the error of the model is no number: a signal it needs was bad in some of these strokes. See "
          "which with 'hydroscope check'",
          "der Fehler des Modells ist keine Zahl: ein Signal, das es braucht, war in einigen dieser Hübe schlecht. "
          "Welches, zeigt 'hydroscope check'");
  if (f.rms_measured <= 0)
    return Tell(
        "no stroke is long enough for an error of the model: see gate and window of the machine file with "
        "'hydroscope check'",
        "kein Hub ist lang genug für einen Fehler des Modells: Gate und Fenster der Maschinendatei zeigt "
        "'hydroscope check'");
  if (f.rms_modelled <= 0)
    return Tell(
        "the model gives 0 throughout where an output was measured: a signal it needs is 0 or missing. "
        "See which with 'hydroscope check'",
        "das Modell ergibt durchweg 0, wo ein Ausgang gemessen wurde: ein Signal, das es braucht, ist 0 oder fehlt. "
        "Welches, zeigt 'hydroscope check'");
  if (f.noise_floor >= f.rms_measured)
    return Tell(
        "sensor noise alone would be {:.0f} % of the measured output: longer blocks ([window]), or a better sensor",
        "Sensorrauschen allein wäre {:.0f} % des gemessenen Ausgangs: längere Blöcke "
        "([window]) oder ein besserer Sensor",
        100 * f.noise_floor / f.rms_measured);
  if (f.rms_residual > f.rms_measured)
    return Tell(
        "the error is {:.0f} % of the measured output: the model describes none of it. Check units, "
        "signs and sampling rate with 'hydroscope check'",
        "der Fehler ist {:.0f} % des gemessenen Ausgangs: das Modell beschreibt nichts davon. Einheiten, Vorzeichen "
        "und Abtastrate prüft 'hydroscope check'",
        100 * f.rms_residual / f.rms_measured);
  if (f.rms_holdout > kUnstable * f.rms_residual)
    return Tell(
        "the error on strokes left out is {:.1f} times that on the strokes of the fit: the fit hangs "
        "on single strokes. Record more of them, at different speeds and pressures",
        "der Fehler auf ausgelassenen Hüben ist {:.1f}-mal der auf den angepassten: die Anpassung hängt an einzelnen "
        "Hüben. Mehr davon aufzeichnen, bei verschiedenen Geschwindigkeiten und Drücken",
        f.rms_holdout / f.rms_residual);
  return {};
}

CauseKind CauseKindOf(const Explanation& x) {
  if (x.verdict == Verdict::kAdequate) return CauseKind::kNotSought;
  if (x.verdict == Verdict::kUnknown) return CauseKind::kNotKnown;
  if (!WhyNotProven(x).empty()) return CauseKind::kNotProven;
  return x.verdict == Verdict::kNamed ? CauseKind::kNamed : CauseKind::kSeveral;
}

bool SwapLeads(const Explanation& x) {
  return x.swap && x.swap->explains && x.verdict != Verdict::kAdequate && x.no_verdict.empty();
}

Told SwapTold(const EffectSwap& swap) {
  if (swap.in.empty())
    return Tell("the model does as well without {}, which it has",
                "das Modell kommt ohne {}, das es hat, ebenso gut aus", swap.out);
  return Tell("the model has {}, and {} in its place does better",
              "das Modell hat {}, und mit {} an dessen Stelle ist es besser", swap.out,
              fmt::to_string(fmt::join(swap.in, " + ")));
}

std::string WhatItMayBe(const CountedWords& counted) {
  return fmt::format(
      "It may be noise that is not white, or a law that no function of the signals shows. Record {} at half the speed and half "
      "the load: noise stays as large, a law does not.",
      counted.many);
}

ModelHeadline HeadlineOf(const GramFit& figures, ErrorFinding found, const Told& no_verdict,
                         const CountedWords& counted, const LeftOut& left_out) {
  std::string why = ImpossibleFigures(figures).english;
  if (why.empty()) why = no_verdict.english;
  if (!why.empty())
    return {ModelStanding::kNotJudged,
            fmt::format("The model cannot be judged on these {}: {}.", counted.many, why)};
  if (found == ErrorFinding::kMayBeNoise)
    return {ModelStanding::kMisses,
            fmt::format("Something is left: {}. {}", kNothingPredicts, WhatItMayBe(counted))};
  if (found == ErrorFinding::kMore)
    return {ModelStanding::kMisses, "The model misses something: the difference is more than sensor noise."};
  if (left_out.odd > 0)
    return {ModelStanding::kDescribesSome,
            fmt::format("The model describes {} of {} down to the sensor noise; {}.", left_out.described(),
                        counted.Counted(left_out.strokes), left_out.which.english)};
  return {ModelStanding::kDescribes,
          fmt::format("The model describes these {} down to the sensor noise.", counted.many)};
}

}  // namespace hydroscope
