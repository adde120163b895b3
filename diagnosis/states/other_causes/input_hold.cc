#include "diagnosis/states/other_causes/input_hold.h"

#include <algorithm>
#include <cmath>

#include "estimation/states/fit_task.h"

namespace hydroscope {
namespace {

/// Energy of the error over its noise with inputs that move in one way; nothing if the model diverges.
std::optional<double> EnergyWith(InputHold hold, const StateFit& fit, std::span<const Episode> episodes,
                                 const StateFitOptions& options) {
  Machine machine = fit.model->machine;
  machine.log.hold = hold;
  const auto model = BuildStateModel(machine, fit.model->effects);
  if (!model) return std::nullopt;
  StateStart start{fit.parameters, fit.initial};
  start.initial.resize(episodes.size());
  const StateFit refit = RefitStates(*model, episodes, std::span(&start, 1), fit.noise, options);
  if (!refit.solved()) return std::nullopt;
  return refit.noise.cwiseQuotient(fit.noise).squaredNorm();
}

}  // namespace

std::optional<OtherHold> FindOtherHold(const StateFit& fit, std::span<const Episode> episodes,
                                       const InputHoldOptions& options) {
  if (fit.model->inputs.empty()) return std::nullopt;
  const std::vector<Episode> few = shooting::FirstRows(episodes, options.rows);
  StateFitOptions short_fit;
  short_fit.iterations = options.iterations;
  const InputHold stated = fit.model->machine.log.hold;
  const auto as_stated = EnergyWith(stated, fit, few, short_fit);
  if (!as_stated) return std::nullopt;
  OtherHold best;
  for (const InputHold hold : {InputHold::kZero, InputHold::kLinear, InputHold::kSmooth}) {
    if (hold == stated) continue;
    const auto energy = EnergyWith(hold, fit, few, short_fit);
    const double error = energy ? std::sqrt(*energy / *as_stated) : 1;
    if (error < best.error) best = {hold, error};
  }
  if (best.error > options.less_error) return std::nullopt;
  return best;
}

Told OtherHoldText(const OtherHold& other) {
  return Tell(
      "with hold = \"{}\" in [log] the error is {:.0f} % of this: the inputs seem to move so between rows; if that may "
      "be, write it into the machine file first",
      "mit hold = \"{}\" in [log] beträgt der Fehler {:.0f} % von diesem: die Eingänge scheinen sich zwischen den Zeilen so "
      "zu bewegen; wenn das sein kann, es zuerst in die Maschinendatei schreiben",
      kInputHoldNames[static_cast<std::size_t>(other.hold)], 100 * other.error);
}

Told TakenHoldText(const OtherHold& taken) {
  const std::string_view name = kInputHoldNames[static_cast<std::size_t>(taken.hold)];
  return Tell(
      "hold = \"{0}\" in [log] leaves {1:.0f} % of the error that inputs on straight lines between rows leave, and is taken; "
      "write it into the machine file",
      "hold = \"{0}\" in [log] lässt {1:.0f} % des Fehlers übrig, den gerade Linien der Eingänge zwischen den Zeilen lassen, und "
      "wird genommen; es in die Maschinendatei schreiben",
      name, 100 * taken.error);
}

}  // namespace hydroscope
