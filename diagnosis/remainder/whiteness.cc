#include "diagnosis/remainder/whiteness.h"

#include <algorithm>
#include <cmath>

#include "core/distributions.h"

namespace hydroscope {

Whiteness WhitenessOf(const Residuals& residuals, int lags) {
  Whiteness out;
  out.lags = lags;
  std::vector<double> products(lags + 1, 0.0), pairs(lags + 1, 0.0);
  for (const StrokeResiduals& stroke : residuals.strokes)
    for (const Eigen::VectorXd& u : stroke.whitened)
      for (int k = 0; k <= lags && k < u.size(); ++k) {
        products[k] += u.head(u.size() - k).dot(u.tail(u.size() - k));
        pairs[k] += static_cast<double>(u.size() - k);
      }
  if (!(products[0] > 0)) return out;
  out.variance_ratio = products[0] / pairs[0];
  for (int k = 1; k <= lags; ++k) {
    const double r = pairs[k] > 0 ? products[k] / pairs[k] / out.variance_ratio : 0.0;
    out.autocorrelation.push_back(r);
    out.ljung_box += pairs[k] * r * r;
    out.share += r * r / lags;
  }
  out.share = std::sqrt(out.share);
  out.p_value = ChiSquaredAbove(out.ljung_box, lags);
  return out;
}

namespace {

struct CorrelationTest {
  double correlation = 0, p_value = 1;
};

/// Residual against the signal `lag` windows before, about the means over all windows.
CorrelationTest CorrelationAt(const Residuals& residuals, int signal, double residual_mean,
                              double signal_mean, int lag) {
  std::vector<double> scores;
  double product = 0, residual2 = 0, signal2 = 0;
  for (const StrokeResiduals& stroke : residuals.strokes) {
    double here = 0;
    const int first = std::max(0, lag), last = std::min(stroke.windows(), stroke.windows() + lag);
    for (int w = first; w < last; ++w) {
      const double residual = stroke.measured[w] - stroke.modelled[w] - residual_mean;
      const double x = stroke.signal(signal, w - lag) - signal_mean;
      here += residual * x;
      residual2 += residual * residual;
      signal2 += x * x;
    }
    if (first < last) scores.push_back(here);
    product += here;
  }
  CorrelationTest out;
  const double scale = std::sqrt(residual2 * signal2);
  if (!(scale > 0) || scores.size() < 2) return out;
  out.correlation = product / scale;
  const double n = static_cast<double>(scores.size());
  double spread = 0;
  for (double score : scores) spread += (score - product / n) * (score - product / n);
  const double std = std::sqrt(spread * n / (n - 1));
  if (std > 0) out.p_value = StudentTwoSided(product / std, n - 1);
  return out;
}

SignalCorrelation CorrelationWith(const Residuals& residuals, int signal, double residual_mean, int most) {
  double sum = 0, windows = 0;
  for (const StrokeResiduals& stroke : residuals.strokes) {
    sum += stroke.signal.row(signal).sum();
    windows += stroke.windows();
  }
  const CorrelationTest now = CorrelationAt(residuals, signal, residual_mean, sum / windows, 0);
  SignalCorrelation out{signal, now.correlation, now.p_value, 0, now.correlation, now.p_value};
  for (int lag = -most; lag <= most; ++lag) {
    const CorrelationTest at = CorrelationAt(residuals, signal, residual_mean, sum / windows, lag);
    if (std::abs(at.correlation) <= std::abs(out.lagged)) continue;
    out.lag = lag;
    out.lagged = at.correlation;
    out.lagged_p = at.p_value;
  }
  out.lagged_p = std::min(1.0, out.lagged_p * (2 * most + 1));
  return out;
}

}  // namespace

std::vector<SignalCorrelation> CorrelationsOf(const Residuals& residuals, int most) {
  double sum = 0, windows = 0;
  for (const StrokeResiduals& stroke : residuals.strokes)
    for (int w = 0; w < stroke.windows(); ++w, ++windows) sum += stroke.measured[w] - stroke.modelled[w];
  std::vector<SignalCorrelation> out;
  for (int s = 0; windows > 0 && s < static_cast<int>(residuals.signals.size()); ++s)
    out.push_back(CorrelationWith(residuals, s, sum / windows, most));
  return out;
}

}  // namespace hydroscope
