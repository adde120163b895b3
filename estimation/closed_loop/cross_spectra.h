#pragma once

#include <complex>
#include <limits>
#include <vector>

#include "core/result.h"
#include "estimation/frequency_response/frequency_response.h"

namespace hydroscope {

/// Products of the spectra of set point R, input U and output Y at one frequency, summed over segments.
struct LoopSums {
  double rr = 0, uu = 0, yy = 0;
  std::complex<double> ru, ry, uy;  ///< conj(R) U, conj(R) Y, conj(U) Y

  LoopSums& operator+=(const LoopSums& other);
  /// Output over input as the ratio of cross spectra with the set point, P_ry/P_ru: what circulates in the loop (disturbances,
  /// noise of the reading) has no part in it.
  std::complex<double> Ratio() const { return ry / ru; }
  /// P_uy/P_uu, biased in closed loop towards the inverse of the controller.
  std::complex<double> Direct() const { return uy / uu; }
  /// Sum of |Y - g U|^2.
  double Residual(std::complex<double> g) const;
  double CoherenceOfInput() const;   ///< of set point and input
  double CoherenceOfOutput() const;  ///< of set point and output
};

/// Averaged spectra of a record in closed loop: Hann window, half overlap (Welch 1967), mean taken off. In place of the output
/// its difference from row to row is transformed: an output that integrates the input would leak from the lowest frequencies
/// into all others. Sums are kept for blocks of consecutive segments, for the errors of what is estimated from them.
struct LoopSpectra {
  std::size_t segment_length = 0;
  int segments = 0;
  double sample_period = 0;                   ///< s
  std::vector<LoopSums> bins;                 ///< of all segments, bin 0 = 0 Hz
  std::vector<std::vector<LoopSums>> blocks;  ///< the same of parts of the record

  double Frequency(std::size_t bin) const;  ///< Hz
  /// 1 - exp(-j w T): what the difference from row to row does to the output.
  std::complex<double> Difference(double frequency) const;
};

struct LoopSpectraOptions {
  /// s; 0.6 Hz between frequencies, and a record of a minute has some seventy segments.
  double segment = 2;
  std::size_t segment_length = 0;  ///< samples; 0: the largest power of two within `segment`
  /// Of the input's magnitude: what is above does not reach the plant.
  double limit = std::numeric_limits<double>::infinity();
  double dead_band = 0;  ///< of the input's magnitude: what is below does not reach the plant
};

/// Error (kBadInput): runs without set point, or too short for eight segments.
Result<LoopSpectra> AverageLoopSpectra(const FrequencyRecord& record, const LoopSpectraOptions& options);

/// Bins at which the input follows the set point; those of mean and trend, and those near the Nyquist frequency, are left out.
std::vector<std::size_t> BinsOfSetPoint(const LoopSpectra& spectra, double lowest = 0,
                                        double highest = std::numeric_limits<double>::infinity());
/// Of which fewer say that set point and input are not related.
inline constexpr std::size_t kFewestBinsOfSetPoint = 20;

/// Independent averages of a segment with a Hann window and half overlap, 1/(1 + 2/36).
inline constexpr double kIndependentShareOfSegment = 1 / (1 + 2.0 / 36);

}  // namespace hydroscope
