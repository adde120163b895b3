#pragma once

#include <optional>
#include <vector>

#include "estimation/closed_loop/cross_spectra.h"

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

}  // namespace hydroscope
