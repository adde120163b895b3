#pragma once

#include <optional>
#include <vector>

#include "core/told.h"
#include "estimation/closed_loop/cross_spectra.h"
#include "models/closed_loop.h"

namespace hydroscope {

/// The magnitude of the input above which it does not reach the plant (an amplifier or a valve that saturates), if there is one:
/// with the input cut off there the output follows it better. Likelihood of what is left, v = y - G u with G = P_ry/P_ru, over
/// the bins of `used` and over limits that cut off between a two-hundredth and half of the rows. Nothing if no limit is more
/// likely than none by more than chance.
std::optional<double> FindInputLimit(const FrequencyRecord& record, const LoopSpectraOptions& options,
                                     const LoopSpectra& spectra, const std::vector<std::size_t>& used);

/// The magnitude of the input below which it does not reach the plant, if there is one, sought as the limit is between a
/// hundredth and half of the rows. A valve with overlap has a dead band, and friction that does not grow with the speed looks
/// like a small one.
std::optional<double> FindDeadBand(const FrequencyRecord& record, const LoopSpectraOptions& options,
                                   const LoopSpectra& spectra, const std::vector<std::size_t>& used);

/// The magnitude at which the readings of the input end: so many lie exactly there and next to none near it, as a logger, an
/// amplifier's monitor or a controller cuts them off. Nothing if they do not.
std::optional<double> FindEndOfReadings(const FrequencyRecord& record);

/// Which of the input's magnitudes reach neither plant nor log. SI.
struct InputRange {
  std::optional<double> input_limit;   ///< FindInputLimit
  std::optional<double> dead_band;     ///< FindDeadBand
  std::optional<double> readings_end;  ///< FindEndOfReadings
};

/// Looks for all of them, limit and dead band over those bins of `used` at which the output follows the set point. Readings that
/// end, and a limit, take from large inputs what a dead band takes from small ones: beside one of these none is sought.
InputRange FindInputRange(const FrequencyRecord& record, const LoopSpectraOptions& options,
                          const LoopSpectra& spectra, const std::vector<std::size_t>& used);

/// That it does not reach the plant, and why; the record is measured with it cut off there.
Told InputLimitText(const ClosedLoopPlant& plant, double limit);
/// That figures go with the size of the excitation, or with where readings end.
std::vector<Told> NonlinearInputTexts(const ClosedLoopPlant& plant, const InputRange& range);
/// The same, and the limit, of figures that take an input that is cut off for a lower gain: those of episodes.
std::vector<Told> InputDoubtsOf(const ClosedLoopPlant& plant, const InputRange& range);

}  // namespace hydroscope
