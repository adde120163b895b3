#pragma once

namespace hydroscope {

/// Figures people compare valves by, of K exp(-s T_dead) / (1 + 2 D s/w0 + (s/w0)^2). f0 in Hz, D 1, dead
/// time in s.

/// Hz at which the gain is 1/sqrt(2) of that at rest: f0 sqrt(b + sqrt(b^2 + 1)), b = 1 - 2 D^2.
double BandwidthOf(double f0, double damping);

/// Hz at which second-order part and dead time together reach -90 degrees, by bisection.
double Phase90Of(double f0, double damping, double dead_time);

/// s until the step response first reaches 90 % of its final value, dead time included.
double RiseTime90Of(double f0, double damping, double dead_time);

}  // namespace hydroscope
