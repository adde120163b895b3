#pragma once

#include <vector>

#include "estimation/states/simulation.h"

namespace hydroscope {

/// Rows per revolution that an episode keeps: what its equations are run over, and Simpson's rule takes means of. Several outputs
/// tell parameters so well that lines between so few inputs would show in them: of these twice as many are kept.
inline constexpr int kRowsPerRevolution = 8;
/// Rows of a log per revolution below which what repeats with the shaft is not seen well enough to be taken out.
inline constexpr double kLeastRowsPerRevolution = 20;

/// The ripple of a shaft taken out of an episode, at any speed and while it changes: rows at equal angles of the shaft (order
/// tracking, Fyfe and Munck, Mechanical Systems and Signal Processing 11, 1997). Each output has one reading per revolution,
/// its mean over it, from which all that repeats with the shaft is gone; the simulation averages what the model gives in the
/// same way (Episode::mean_rows), so no step is bent. A revolution in which a reading is missing has none. Signals that are
/// inputs become those lines between the new rows (`hold` zero: levels) that lie closest to the readings in least squares.
/// `speed`: signal of the shaft's speed, rad/s, of which all readings are good.
Episode AtShaftAngles(const Episode& episode, int speed, const std::vector<int>& outputs, InputHold hold);

/// Rows of the log per revolution, on average; 0 if the shaft stands still.
double RowsPerRevolution(const Episode& episode, int speed);

}  // namespace hydroscope
