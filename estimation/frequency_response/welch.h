#pragma once

#include <vector>

#include "estimation/frequency_response/frequency_response.h"

namespace hydroscope {

/// A Hann window ties the random errors of neighbouring bins: 1 + 2 ((2/3)^2 + (1/6)^2).
inline constexpr double kHannCorrelation = 1 + 2 * (4.0 / 9 + 1.0 / 36);

struct WelchSpectra {
  std::vector<FrequencyPoint> points;
  std::size_t segment_length = 0;
  int segments = 0;
};

/// Averaged cross spectra of command and response: Hann window, segments overlapping by half, mean taken off.
///
///   H1 = S_uy / S_uu,   coherence = |S_uy|^2 / (S_uu S_yy)
///
/// Variance per component of H1: |H1|^2 (1 - coherence) / (2 n_d coherence), n_d the number of independent
/// averages of the overlapping segments (Bendat and Piersol 2010, eq. 9.90; overlap: Welch 1967), or the
/// heteroscedasticity-consistent sum over segments where that is larger: a chirp excites each frequency in a
/// few segments only. Points below `min_coherence` (or below what chance gives at any of the bins in one of a
/// hundred cases) are marked kLowCoherence, coherent ones where the command has hardly any power kNoPower.
/// Bins 0 and 1 (mean and trend) are left out. `segment_length` 0 chooses the largest power of two with at
/// least eight of them in the longest run.
Result<WelchSpectra> EstimateByWelch(const FrequencyRecord& record, const FrequencyResponseOptions& options);

}  // namespace hydroscope
