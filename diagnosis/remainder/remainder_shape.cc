#include "diagnosis/remainder/remainder_shape.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/non_negative.h"

namespace hydroscope {
namespace {

constexpr int kIntervals = 10, kBasis = kIntervals + 3;
constexpr int kPoints = 25;
constexpr double kTails = 0.01;  ///< share of the windows beyond either end of the curve
constexpr double kLeastExplained = 0.05;
constexpr double kSignificant = 3.0;  ///< standard errors of the energy a curve must predict
constexpr std::array<double, 5> kSmoothness = {1e-3, 1e-2, 1e-1, 1.0, 10.0};  ///< penalty over mean diagonal

using Basis = Eigen::Matrix<double, kBasis, 1>;
using Normal = Eigen::Matrix<double, kBasis, kBasis>;

/// Uniform cubic B-splines over 0 ... 1; beyond, the value at the end.
Basis SplinesAt(double x) {
  Basis out = Basis::Zero();
  const double at = std::clamp(x, 0.0, 1.0) * kIntervals;
  const int interval = std::min(static_cast<int>(at), kIntervals - 1);
  const double u = at - interval, v = 1 - u;
  out[interval] = v * v * v / 6;
  out[interval + 1] = (3 * u * u * u - 6 * u * u + 4) / 6;
  out[interval + 2] = (3 * v * v * v - 6 * v * v + 4) / 6;
  out[interval + 3] = u * u * u / 6;
  return out;
}

/// Sum of squared second differences of the coefficients.
Normal Penalty() {
  Normal out = Normal::Zero();
  for (int k = 0; k + 2 < kBasis; ++k) {
    Basis d = Basis::Zero();
    d[k] = 1;
    d[k + 1] = -2;
    d[k + 2] = 1;
    out += d * d.transpose();
  }
  return out;
}

/// Normal equations of one stroke.
struct Sums {
  Normal h = Normal::Zero();
  Basis g = Basis::Zero();
};

/// Curves over one signal for one smoothness.
struct Curves {
  double removed = -std::numeric_limits<double>::infinity();  ///< error energy predicted on strokes left out
  double std = 0;                                             ///< of `removed`, clustered by stroke
  Basis all = Basis::Zero();
  std::vector<Basis> without;  ///< each stroke
};

Basis Solve(const Sums& sums, double smoothness) {
  static const Normal penalty = Penalty();
  const double scale = sums.h.trace() / kBasis;
  // The ridge holds coefficients that no window touches.
  return (sums.h + smoothness * scale * penalty + 1e-9 * scale * Normal::Identity()).ldlt().solve(sums.g);
}

Curves CurvesOf(const std::vector<Sums>& strokes, const Sums& total, double smoothness) {
  Curves out;
  out.all = Solve(total, smoothness);
  out.removed = 0;
  double squares = 0;
  for (const Sums& stroke : strokes) {
    const Basis c = Solve({total.h - stroke.h, total.g - stroke.g}, smoothness);
    const double removed = 2 * c.dot(stroke.g) - c.dot(stroke.h * c);
    out.removed += removed;
    squares += removed * removed;
    out.without.push_back(c);
  }
  const double n = static_cast<double>(strokes.size());
  out.std = std::sqrt(NonNegative((squares - out.removed * out.removed / n) * n / (n - 1)));
  return out;
}

/// The range of the signal without its tails.
std::pair<double, double> RangeOf(const Residuals& residuals, int signal) {
  std::vector<double> values;
  for (const StrokeResiduals& stroke : residuals.strokes)
    for (int w = 0; w < stroke.windows(); ++w) values.push_back(stroke.signal(signal, w));
  if (values.empty()) return {0.0, 0.0};
  std::sort(values.begin(), values.end());
  const auto tail = static_cast<std::size_t>(kTails * static_cast<double>(values.size()));
  return {values[tail], values[values.size() - 1 - tail]};
}

double ExcessEnergy(const Residuals& residuals) {
  double sum = 0;
  for (const StrokeResiduals& stroke : residuals.strokes)
    for (int w = 0; w < stroke.windows(); ++w) {
      const double error = stroke.measured[w] - stroke.modelled[w];
      sum += error * error - stroke.noise_variance[w];
    }
  return sum;
}

RemainderShape ShapeOver(const Residuals& residuals, int index, double excess) {
  const ResidualSignal& signal = residuals.signals[index];
  const auto [low, high] = RangeOf(residuals, index);
  RemainderShape out{signal.name, signal.unit, 0, {}};
  if (!(high > low)) return out;
  std::vector<Sums> strokes;
  Sums total;
  for (const StrokeResiduals& stroke : residuals.strokes) {
    Sums sums;
    for (int w = 0; w < stroke.windows(); ++w) {
      const Basis b = SplinesAt((stroke.signal(index, w) - low) / (high - low));
      sums.h += b * b.transpose();
      sums.g += (stroke.measured[w] - stroke.modelled[w]) * b;
    }
    total.h += sums.h;
    total.g += sums.g;
    strokes.push_back(sums);
  }
  Curves best;
  for (double smoothness : kSmoothness) {
    Curves curves = CurvesOf(strokes, total, smoothness);
    if (curves.removed > best.removed) best = std::move(curves);
  }
  if (best.removed > kSignificant * best.std) out.explained = std::min(1.0, best.removed / excess);
  const double n = static_cast<double>(strokes.size());
  for (int k = 0; k < kPoints; ++k) {
    const double share = static_cast<double>(k) / (kPoints - 1);
    const Basis b = SplinesAt(share);
    double mean = 0, spread = 0;
    for (const Basis& c : best.without) mean += b.dot(c) / n;
    for (const Basis& c : best.without) spread += std::pow(b.dot(c) - mean, 2);
    out.points.push_back({(low + share * (high - low)) * signal.factor + signal.offset, b.dot(best.all),
                          StudentFactor(n - 1) * std::sqrt((n - 1) / n * spread)});
  }
  return out;
}

}  // namespace

std::optional<RemainderShape> ShapeOfRemainder(const Residuals& residuals) {
  const double excess = ExcessEnergy(residuals);
  if (residuals.strokes.size() < 3 || !(excess > 0)) return std::nullopt;
  std::optional<RemainderShape> best;
  for (int s = 0; s < static_cast<int>(residuals.signals.size()); ++s) {
    RemainderShape shape = ShapeOver(residuals, s, excess);
    if (shape.explained >= kLeastExplained && (!best || shape.explained > best->explained))
      best = std::move(shape);
  }
  return best;
}

}  // namespace hydroscope
