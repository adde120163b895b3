#pragma once

#include <map>

#include "diagnosis/extended_fit.h"
#include "models/stretch.h"

namespace hydroscope {

/// What is done to a recorded stroke so that it stands for one nobody has recorded.
struct StrokeMove {
  std::map<int, double> shift;  ///< added to channels, SI
  double speed = 1;             ///< the stroke is run through so many times as fast
};

/// The stroke with its first `measured` channels shifted and read at other times, linear between samples;
/// cut into stretches as the segmenter cuts them. What is left of a run of samples after whole blocks is left
/// out, and so are runs too short for equations.
StrokeStretches MovedStroke(const StrokeStretches& recorded, const StrokeMove& move, int measured,
                            const WindowSamples& window);

/// Mean of a channel over a stroke.
double MeanOf(const StrokeStretches& stroke, int channel);
/// Mean magnitude of the rate at which a channel changes from end to end of the stretches of a stroke, per s.
double SpeedOf(const StrokeStretches& stroke, int channel, const WindowSamples& window);

}  // namespace hydroscope
