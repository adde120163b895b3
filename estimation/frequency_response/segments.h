#pragma once

#include <complex>
#include <cstddef>
#include <span>
#include <vector>

namespace hydroscope {

/// A part of the command in which one frequency is held with one amplitude.
struct HeldSine {
  std::size_t begin = 0, end = 0;  ///< samples [begin, end)
  double omega = 0;                ///< rad per sample
  double amplitude = 0;
  double noise = 0;  ///< standard deviation of the command about the sine
};

struct HeldSines {
  std::vector<HeldSine> found;
  std::size_t active = 0;        ///< samples in which the command moves at all
  std::size_t covered = 0;       ///< samples inside `found`
  std::size_t stair_length = 1;  ///< samples between refreshes of the command; 1: no stairs seen
  int unsteady = 0;              ///< stretches of regular crossings whose frequency or amplitude drifts
};

/// Finds the held frequencies of a command by itself:
/// 1. upward zero crossings about the median, with a hysteresis that follows the amplitude;
/// 2. crossings that lie on one straight line over their number (within 6 % of a period) form a stretch;
/// 3. the frequency is refined by least squares through the phases of blocks of whole periods;
/// 4. the block phasors must agree (2 %, or what the command's noise explains); a stretch that falls into two
///    steady halves (amplitude or phase jump) is cut there, one that drifts is counted as unsteady;
/// 5. the edges are moved out sample by sample as long as the sine predicts the command.
/// A command in regular stairs (refreshed every few samples) is searched with one sample per stair.
/// Needs three periods per frequency and more than 2.5 samples per period.
HeldSines FindHeldSines(std::span<const double> command);

}  // namespace hydroscope
