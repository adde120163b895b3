#include "estimation/trend_statistics.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/constants.h"
#include "core/distributions.h"
#include "core/quantile.h"
#include "estimation/decompositions.h"

namespace hydroscope {
namespace {

constexpr double kMostCorrelation = 0.99;
/// Of a correlation by its bias: with so few residuals it is hardly known.
constexpr double kLeastLeft = 0.2;

double EffectiveCount(std::size_t n, double correlation) {
  return static_cast<double>(n) * (1 - correlation) / (1 + correlation);
}

/// Degrees of freedom of an error found from n values with p unknowns: all if the correlation was known
/// beforehand, those of the effective count (at least 2) if it was found from the same values.
double Degrees(double n, double effective, double p, bool correlation_found) {
  return correlation_found ? std::clamp(effective - p, 2.0, n - p) : n - p;
}

/// The correlation to use: the one known beforehand unless the one found exceeds it by more than its own error.
double Settle(double found, double known, std::size_t n) {
  known = std::clamp(known, 0.0, kMostCorrelation);
  const double tolerance = known > 0 ? 2 * std::sqrt((1 - known * known) / static_cast<double>(n)) : 0;
  return found > known + tolerance ? std::min(found, kMostCorrelation) : known;
}

bool AllPositive(const std::vector<double>& values) {
  return std::ranges::all_of(values, [](double v) { return std::isfinite(v) && v > 0; });
}

/// Weights about 1, from the stated standard deviations; one suspiciously certain value must not rule the fit.
Eigen::VectorXd RowWeights(const std::vector<double>& std, std::size_t n) {
  Eigen::VectorXd weights = Eigen::VectorXd::Ones(n);
  if (std.size() != n || !AllPositive(std)) return weights;
  const double typical = Median(std, kNaN);
  for (std::size_t i = 0; i < n; ++i) weights(i) = typical / std::max(std[i], typical / 2);
  return weights;
}

/// A lag-one correlation found from n residuals of p unknowns, freed from its bias -(p + (p + 2) phi)/n.
double CorrectedCorrelation(double raw, double p, double n) {
  return std::clamp((raw + p / n) / std::max(kLeastLeft, 1 - (p + 2) / n), 0.0, kMostCorrelation);
}

/// What the columns of x and a change leave of y, and how many unknowns the change and the search for it spent.
struct Leftover {
  Eigen::VectorXd values;
  double unknowns = 0;

  /// Of successive values, beside `columns` unknowns of x.
  double Correlation(Eigen::Index columns) const {
    const Eigen::Index n = values.size();
    const double square = values.squaredNorm();
    if (square <= 0) return 0;
    const double raw = values.head(n - 1).dot(values.tail(n - 1)) / square;
    return CorrectedCorrelation(raw, static_cast<double>(columns) + unknowns, static_cast<double>(n));
  }
};

/// The changes that LeftBy tries: a step, or a line that goes on elsewhere at another slope.
enum class ChangeShape { kStep, kBrokenLine };
constexpr double kSearch = 1;  ///< unknowns that the place of a change counts as
/// Share of the squares a step leaves that two lines must leave at most.
constexpr double kBetterThanAStep = 0.5;

/// What is left of y by the columns of x and the change at one place that fits best beside them: neither a jump nor a drift
/// that begins somewhere must pass for slow wandering, which would hide it.
Leftover LeftBy(const Eigen::MatrixXd& x, const Eigen::VectorXd& y, ChangeShape shape) {
  const Eigen::Index n = x.rows(), added = shape == ChangeShape::kStep ? 1 : 2;
  const Eigen::MatrixXd basis = OrthonormalBasis(x);
  const auto beside = [&](const Eigen::MatrixXd& v) -> Eigen::MatrixXd {
    return v - basis * (basis.transpose() * v);
  };
  const Eigen::VectorXd residuals = beside(y);
  Leftover best{residuals, static_cast<double>(added) + kSearch};
  const Eigen::Index stride = std::max<Eigen::Index>(1, n / 60);
  for (Eigen::Index at = 2; at + 2 <= n; at += stride) {
    Eigen::MatrixXd change = Eigen::MatrixXd::Zero(n, added);
    change.col(0).tail(n - at).setOnes();
    if (added > 1) change.col(1).tail(n - at).setLinSpaced(1, static_cast<double>(n - at));
    change = beside(change);
    const Eigen::VectorXd left =
        residuals -
        change * SymmetricFactor(change.transpose() * change).Solve(change.transpose() * residuals);
    if (left.squaredNorm() < best.values.squaredNorm()) best.values = left;
  }
  return best;
}

/// A constant and a straight line over the number of a value.
Eigen::MatrixXd Line(std::size_t n) {
  Eigen::MatrixXd x(n, 2);
  x << Eigen::VectorXd::Ones(n), Eigen::VectorXd::LinSpaced(static_cast<Eigen::Index>(n), -1, 1);
  return x;
}

Eigen::MatrixXd Whitened(const Eigen::MatrixXd& rows, double correlation) {
  Eigen::MatrixXd out = rows;
  out.row(0) *= std::sqrt(1 - correlation * correlation);
  out.bottomRows(rows.rows() - 1) -= correlation * rows.topRows(rows.rows() - 1);
  return out;
}

/// Mean square of differences without the largest twentieth (a jump is no scatter), raised
/// by what the trimming takes from normal scatter: P(chi2_3 < q) / P(chi2_1 < q) at the trimming point q.
double TrimmedMeanSquare(const std::vector<double>& differences) {
  std::vector<double> squares;
  for (const double difference : differences) squares.push_back(difference * difference);
  std::ranges::sort(squares);
  const std::size_t kept = squares.size() - squares.size() / 20;
  const double share = static_cast<double>(kept) / static_cast<double>(squares.size());
  const double left = kept == squares.size() ? 1 : ChiSquaredBelow(ChiSquaredQuantile(share, 1), 3) / share;
  const double sum = std::accumulate(squares.begin(), squares.begin() + kept, 0.0);
  return sum / static_cast<double>(kept) / left;
}

std::vector<double> Differences(const std::vector<double>& y) {
  std::vector<double> out;
  for (std::size_t i = 1; i < y.size(); ++i) out.push_back(y[i] - y[i - 1]);
  return out;
}

/// Of the difference between the means of the last and the first `count` of n values, each of which is the one before and an
/// independent step of variance 1.
double VarianceOfWandering(std::size_t n, std::size_t count) {
  double sum = static_cast<double>(n - 2 * count) + 1;
  for (std::size_t k = 1; k < count; ++k) {
    const double share = static_cast<double>(k) / static_cast<double>(count);
    sum += 2 * share * share;
  }
  return sum;
}

/// The change against errors that wander freely, as far as errors can hang together. How far they step is taken from second
/// differences, into which a drift, straight or curved, hardly enters: one that is long and large against them is no
/// wandering, whatever its course. `stated`: standard deviation of a value, 0 = unknown.
TestedValue AgainstWandering(const std::vector<double>& y, const ThirdsComparison& thirds, double stated) {
  const double step = std::max(TrimmedMeanSquare(Differences(Differences(y))), 6 * stated * stated) / 2;
  const double degrees = (static_cast<double>(y.size()) - 2) / 2;  // second differences share values
  return {thirds.last - thirds.first, std::sqrt(step * VarianceOfWandering(y.size(), thirds.count)), degrees};
}

double WeightedMean(const double* y, const double* weight, std::size_t n) {
  const double total = std::accumulate(weight, weight + n, 0.0);
  return std::inner_product(y, y + n, weight, 0.0) / total;
}

}  // namespace

TestedValue::TestedValue() : value(kNaN), std(kNaN) {}

TestedValue::TestedValue(double value_in, double std_in, double degrees_in)
    : value(value_in), std(std_in), degrees(degrees_in) {
  if (!Known()) return;
  if (std <= 0) {
    p = value == 0 ? 1 : 0;
    return;
  }
  p = StudentTwoSided(value / std, degrees);
}

bool TestedValue::Known() const { return std::isfinite(value) && std::isfinite(std) && degrees > 0; }

double TestedValue::HalfWidth() const {
  if (!Known()) return kNaN;
  return std * StudentHalfWidth95(degrees);
}

Significance SignificanceOf(const TestedValue& tested) {
  if (!tested.Known() || tested.p >= kHintBelow) return Significance::kNone;
  return tested.p < kClearBelow ? Significance::kClear : Significance::kHint;
}

void AdjustForFamily(const std::vector<double*>& family) {
  std::vector<double*> sorted = family;
  std::ranges::sort(sorted, [](const double* a, const double* b) { return *a < *b; });
  double largest = 0;
  for (std::size_t k = 0; k < sorted.size(); ++k) {
    largest = std::max(largest, std::min(1.0, *sorted[k] * static_cast<double>(sorted.size() - k)));
    *sorted[k] = largest;
  }
}

double CorrelatedFit::JointP(std::size_t first) const {
  const auto p = static_cast<Eigen::Index>(coefficients.size()), from = static_cast<Eigen::Index>(first);
  if (p <= from) return 1;
  Eigen::VectorXd tested(p - from);
  for (Eigen::Index j = from; j < p; ++j) tested(j - from) = coefficients[j].value;
  const Eigen::Map<const Eigen::MatrixXd> all(covariance.data(), p, p);
  const double f = tested.dot(SymmetricFactor(all.bottomRightCorner(p - from, p - from)).Solve(tested)) /
                   static_cast<double>(p - from);
  if (!(f >= 0)) return 1;
  return FisherAbove(f, static_cast<double>(p - from), coefficients.front().degrees);
}

double CorrelatedFit::StdAt(const std::vector<double>& x) const {
  const std::size_t n = coefficients.size();
  double variance = 0;
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j) variance += x[i] * covariance[i * n + j] * x[j];
  return std::sqrt(std::max(variance, 0.0));
}

CorrelatedFit FitCorrelated(const std::vector<std::vector<double>>& x, const std::vector<double>& y,
                            const std::vector<double>& std, double least_correlation) {
  const auto n = static_cast<Eigen::Index>(y.size()), p = static_cast<Eigen::Index>(x.size());
  if (n < p + 3) return {};
  Eigen::MatrixXd rows(n, p + 1);
  for (Eigen::Index j = 0; j < p; ++j) rows.col(j) = Eigen::Map<const Eigen::VectorXd>(x[j].data(), n);
  rows.col(p) = Eigen::Map<const Eigen::VectorXd>(y.data(), n);
  rows = RowWeights(std, y.size()).asDiagonal() * rows;

  const double correlation = Settle(LeftBy(rows.leftCols(p), rows.col(p), ChangeShape::kStep).Correlation(p),
                                    least_correlation, y.size());
  const Eigen::MatrixXd white = Whitened(rows, correlation);
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(white.leftCols(p));
  qr.setThreshold(1e-10);
  if (qr.rank() < p) return {};
  const Eigen::VectorXd beta = qr.solve(white.col(p));
  const double variance =
      (white.col(p) - white.leftCols(p) * beta).squaredNorm() / static_cast<double>(n - p);
  const Eigen::MatrixXd covariance = variance * Inverse(white.leftCols(p).transpose() * white.leftCols(p));
  const double degrees = Degrees(static_cast<double>(n), EffectiveCount(y.size(), correlation),
                                 static_cast<double>(p), correlation > least_correlation);
  CorrelatedFit fit;
  fit.correlation = correlation;
  fit.residual_std = std::sqrt(variance / (1 - correlation * correlation));
  for (Eigen::Index j = 0; j < p; ++j)
    fit.coefficients.emplace_back(beta(j), std::sqrt(covariance(j, j)), degrees);
  for (Eigen::Index i = 0; i < p; ++i)
    for (Eigen::Index j = 0; j < p; ++j) fit.covariance.push_back(covariance(i, j));
  return fit;
}

ThirdsComparison CompareThirds(const std::vector<double>& y, const std::vector<double>& std,
                               double least_correlation) {
  ThirdsComparison result;
  if (y.size() < 6) return result;
  result.count = y.size() / 3;
  const Eigen::VectorXd row_weights = RowWeights(std, y.size());
  const Eigen::VectorXd weights = row_weights.cwiseAbs2();
  const std::size_t last = y.size() - result.count;
  result.first = WeightedMean(y.data(), weights.data(), result.count);
  result.last = WeightedMean(y.data() + last, weights.data() + last, result.count);

  const Eigen::MatrixXd line = Line(y.size());
  const Eigen::Map<const Eigen::VectorXd> values(y.data(), static_cast<Eigen::Index>(y.size()));
  Leftover left = LeftBy(line, values, ChangeShape::kStep);
  if (Leftover broken = LeftBy(line, values, ChangeShape::kBrokenLine);
      broken.values.squaredNorm() <= kBetterThanAStep * left.values.squaredNorm())
    left = std::move(broken);
  result.correlation = Settle(left.Correlation(line.cols()), least_correlation, y.size());
  const double scatter = TrimmedMeanSquare(Differences(y)) / (2 * (1 - result.correlation));
  const auto variance_of = [&](std::size_t begin) {
    const double stated =
        std.size() == y.size()
            ? Median({std.begin() + begin, std.begin() + static_cast<std::ptrdiff_t>(begin + result.count)},
                     kNaN)
            : 0;
    const double one_value = std::max(scatter, std::isfinite(stated) ? stated * stated : 0);
    return one_value / std::max(1.0, EffectiveCount(result.count, result.correlation));
  };
  const double effective = EffectiveCount(result.count, result.correlation);
  const double degrees = Degrees(2 * static_cast<double>(result.count), 2 * effective, 2,
                                 result.correlation > least_correlation);
  result.first_std = std::sqrt(variance_of(0));
  result.change =
      TestedValue(result.last - result.first, std::sqrt(variance_of(0) + variance_of(last)), degrees);
  if (least_correlation > 0) return result;  // values that share data step by less than they scatter
  const double stated = std.size() == y.size() ? Median(std, 0) : 0;
  if (const TestedValue wandering = AgainstWandering(y, result, stated);
      wandering.std > 0 && wandering.p < result.change.p)
    result.change = wandering;
  return result;
}

double SquaredCorrelation(const std::vector<double>& a, const std::vector<double>& b) {
  const auto n = static_cast<double>(a.size());
  const double mean_a = std::accumulate(a.begin(), a.end(), 0.0) / n,
               mean_b = std::accumulate(b.begin(), b.end(), 0.0) / n;
  double aa = 0, bb = 0, ab = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    aa += (a[i] - mean_a) * (a[i] - mean_a);
    bb += (b[i] - mean_b) * (b[i] - mean_b);
    ab += (a[i] - mean_a) * (b[i] - mean_b);
  }
  return aa > 0 && bb > 0 ? ab * ab / (aa * bb) : 0;
}

}  // namespace hydroscope
