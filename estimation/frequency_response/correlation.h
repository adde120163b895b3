#pragma once

#include <span>
#include <vector>

#include "estimation/frequency_response/frequency_response.h"
#include "estimation/frequency_response/harmonics.h"
#include "estimation/frequency_response/segments.h"

namespace hydroscope {

/// How long the transient after a change of frequency must be left out.
struct SettleRule {
  double fixed = -1;          ///< samples; negative: not given
  double time_constant = -1;  ///< samples, slowest decay of the model found so far; negative: no model yet
  double dead_time = 0;       ///< samples
};

/// Frequency, gain and phase of one held frequency.
///
/// Left out at the start: `fixed` if given; with a model its dead time plus as many time constants as it
/// takes the transient to fall below a tenth of the standard error (7 % ... 1e-6); without a model two fifths
/// of the hold. Then blocks at the start whose response is more than 5 standard deviations off that of the
/// others. Evaluated is the largest number of whole periods at the end of the hold, command and response
/// alike, so that noise and phase of the measured command count too: G = Y / U.
///
/// `sums` are those of the hold. The variance is that of the mean over up to 16 blocks of whole periods, which holds for coloured noise
/// too; PoolVariances() steadies it.
struct CorrelatedPoint {
  FrequencyPoint point;
  double white_variance = 0;  ///< per component, from the residuals if they were white
};
CorrelatedPoint CorrelateHeldSine(const SignalRun& run, double sample_period, const HeldSine& held,
                                  const HeldSineSums& sums, const SettleRule& settle);

/// Empirical Bayes shrinkage of the block variances towards `white_variance` times a common factor (Smyth
/// 2004, Stat. Appl. Genet. Mol. Biol. 3(1), art. 3, sec. 6.2): where the ratios of the two scatter no more
/// than their few degrees of freedom explain, all points share one well-known factor; where they do (hum at
/// one frequency), every point keeps its own.
void PoolVariances(std::vector<CorrelatedPoint>& points);

/// True if a share of the samples sits on the signal's own extreme that no sine of its resolution explains.
bool LooksClipped(std::span<const double> signal);

}  // namespace hydroscope
