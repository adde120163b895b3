#include "diagnosis/whiteness.h"

#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>

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
  }
  out.p_value = boost::math::cdf(boost::math::complement(boost::math::chi_squared(lags), out.ljung_box));
  return out;
}

namespace {

/// Sums of one stroke: signal against residual, about the means over all windows.
struct Score {
  double product = 0, residual2 = 0, signal2 = 0;
};

SignalCorrelation CorrelationWith(const Residuals& residuals, int signal, double residual_mean) {
  double sum = 0, windows = 0;
  for (const StrokeResiduals& stroke : residuals.strokes) {
    sum += stroke.signal.row(signal).sum();
    windows += stroke.windows();
  }
  const double mean = sum / windows;
  std::vector<double> scores;
  Score total;
  for (const StrokeResiduals& stroke : residuals.strokes) {
    Score here;
    for (int w = 0; w < stroke.windows(); ++w) {
      const double residual = stroke.measured[w] - stroke.modelled[w] - residual_mean;
      const double x = stroke.signal(signal, w) - mean;
      here.product += residual * x;
      here.residual2 += residual * residual;
      here.signal2 += x * x;
    }
    if (stroke.windows() > 0) scores.push_back(here.product);
    total.product += here.product;
    total.residual2 += here.residual2;
    total.signal2 += here.signal2;
  }
  SignalCorrelation out{signal, 0, 1};
  const double scale = std::sqrt(total.residual2 * total.signal2);
  if (!(scale > 0) || scores.size() < 2) return out;
  out.correlation = total.product / scale;
  const double n = static_cast<double>(scores.size());
  double spread = 0;
  for (double score : scores) spread += (score - total.product / n) * (score - total.product / n);
  const double std = std::sqrt(spread * n / (n - 1));
  if (std > 0)
    out.p_value = 2 * boost::math::cdf(boost::math::complement(boost::math::students_t(n - 1),
                                                               std::abs(total.product) / std));
  return out;
}

}  // namespace

std::vector<SignalCorrelation> CorrelationsOf(const Residuals& residuals) {
  double sum = 0, windows = 0;
  for (const StrokeResiduals& stroke : residuals.strokes)
    for (int w = 0; w < stroke.windows(); ++w, ++windows) sum += stroke.measured[w] - stroke.modelled[w];
  std::vector<SignalCorrelation> out;
  for (int s = 0; windows > 0 && s < static_cast<int>(residuals.signals.size()); ++s)
    out.push_back(CorrelationWith(residuals, s, sum / windows));
  return out;
}

}  // namespace hydroscope
