#pragma once

#include <cstdint>
#include <vector>

namespace hydroscope {

/// What is put on a machine's input to identify it.
enum class Excitation {
  kMultisine,      ///< many sines of random phase
  kFilteredNoise,  ///< white noise through a low pass of order 2
  kGrowing,        ///< the same, its amplitude growing from a tenth to all and again
  kSteps,          ///< levels held over random times
};

/// About zero, its rms about 1, with little above `highest` (cycles per row). A longer one of the same seed begins
/// with the shorter.
std::vector<double> ExcitationOf(Excitation kind, int rows, double highest, std::uint64_t seed);

}  // namespace hydroscope
