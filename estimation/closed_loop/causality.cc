#include "estimation/closed_loop/causality.h"

#include <cmath>

#include "core/constants.h"
#include "core/told_error.h"

namespace hydroscope {
namespace {

/// A delay is below 0 from so many standard deviations and so much of a row.
constexpr double kSureOfDelay = 4, kLeastOfRow = 0.05;

}  // namespace

Status CheckCausality(const ClosedLoopPlant& plant, const LoopEstimate& estimate, double sample_period) {
  for (std::size_t i = 0; i < plant.parameters.size(); ++i) {
    const LoopParameter& parameter = plant.parameters[i];
    if (parameter.kind != LoopParameter::Kind::kDelay) continue;
    const double delay = estimate.parameters[i], std = estimate.Std(parameter, i);
    const double rows = delay / sample_period;
    if (rows > -kSureOfDelay * std / sample_period - kLeastOfRow) continue;
    if (std::abs(rows - std::round(rows)) < kLeastOfRow) continue;
    return BadInput(Tell(
        "{} answers {:.3g} ± {:.2g} ms before {}, which no plant does. Either these rows are slower than the controller, whose "
        "steps between them are missing (or the two columns are a part of a row apart): record every row of the controller. Or "
        "something moves along that the transfer function does not have, a resonance of the fixture or another mode: look for "
        "peaks and dips of the measured gain, and record without the fixture",
        "{} antwortet {:.3g} ± {:.2g} ms vor {}, was keine Strecke tut. Entweder sind diese Zeilen langsamer als der Regler, "
        "dessen Stufen dazwischen fehlen (oder die zwei Spalten sind um einen Teil einer Zeile verschoben): jede Zeile des "
        "Reglers aufzeichnen. Oder es schwingt etwas mit, das die Übertragungsfunktion nicht hat, eine Resonanz der Aufnahme "
        "oder eine andere Eigenform: in der gemessenen Verstärkung nach Spitzen und Einbrüchen sehen, und ohne Aufnahme aufzeichnen",
        plant.output, -1e3 * delay, 1e3 * kNormal95 * std, plant.input));
  }
  return {};
}

}  // namespace hydroscope
