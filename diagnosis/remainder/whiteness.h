#pragma once

#include <vector>

#include "diagnosis/remainder/residuals.h"

namespace hydroscope {

/// When what a model leaves is no sensor noise, whatever its size. On healthy logs p-values are even: one in a million is below
/// `max_p`, and the share keeps long logs from being blamed for a trifle (`hydroscope benchmark plant-logs`).
struct WhitenessOptions {
  double max_p = 1e-6;
  double min_share = 0.05;  ///< of the error's energy that goes on from block to block
};

/// Whether what the model leaves is independent from block to block, as sensor noise is.
struct Whiteness {
  int lags = 0;
  std::vector<double> autocorrelation;  ///< at lags 1 ... lags
  double ljung_box = 0;                 ///< statistic
  double p_value = 1;                   ///< chi-squared with `lags` degrees of freedom
  double variance_ratio = 0;            ///< residual variance over that of sensor noise; 1 = noise alone
  double share = 0;                     ///< root mean square of the autocorrelation: what goes on

  /// Sensor noise that is white from row to row does not do this: the model misses something, named or not.
  bool IsStructured(const WhitenessOptions& options = {}) const {
    return p_value < options.max_p && share > options.min_share;
  }
};

/// Of the whitened contrasts, which do not overlap (StrokeResiduals::whitened), pooled over spans; pairs
/// never cross a span. Test after Ljung and Box 1978, with the pairs at hand in place of n (n + 2) / (n - k).
Whiteness WhitenessOf(const Residuals& residuals, int lags = 5);

/// Cross-correlation of the flow residual with a signal over all windows.
struct SignalCorrelation {
  int signal = 0;          ///< index into Residuals::signals
  double correlation = 0;  ///< -1 ... 1, at the same time
  double p_value = 1;   ///< of no correlation, from the stroke-wise sums (t of strokes - 1): windows overlap
  int lag = 0;          ///< windows by which the residual follows the signal (below 0: precedes it) most
  double lagged = 0;    ///< correlation there
  double lagged_p = 1;  ///< of no correlation at any of the lags (Bonferroni)
};
/// Lags up to `most` windows either way; a pair of windows with a gap between them counts as if there were none.
std::vector<SignalCorrelation> CorrelationsOf(const Residuals& residuals, int most = 5);

}  // namespace hydroscope
