#pragma once

#include <vector>

namespace hydroscope {

/// A quantity compared with zero: value, standard error, degrees of freedom of the error and two-sided p of
/// Student's t test. NaN value and p = 1 if it could not be found.
struct TestedValue {
  double value;
  double std;
  double degrees = 0;
  double p = 1;
  TestedValue();
  TestedValue(double value, double std, double degrees);
  bool Known() const;
  /// Half width of the 95 % interval.
  double HalfWidth() const;
};

inline constexpr double kClearBelow = 0.01;  ///< p of a finding
inline constexpr double kHintBelow = 0.05;   ///< p of a hint
enum class Significance { kNone, kHint, kClear };
Significance SignificanceOf(const TestedValue& tested);

/// Raises the p of questions asked together to family-wise levels: the chance that any of them shows as much
/// where there is nothing (Holm 1979).
void AdjustForFamily(const std::vector<double*>& family);

/// A straight line or plane fitted to successive values, whose errors are a first-order autoregression.
struct CorrelatedFit {
  std::vector<TestedValue> coefficients;
  double correlation = 0;   ///< of successive errors
  double residual_std = 0;  ///< of one value about the fit
  /// Standard error of the fitted value at regressors `x`.
  double StdAt(const std::vector<double>& x) const;
  /// p of the F test that the coefficients from `first` on are all 0.
  double JointP(std::size_t first) const;
  std::vector<double> covariance;  ///< of the coefficients, row by row
};

/// Generalised least squares of y on the columns of `x` (each as long as y; give a column of ones for the intercept)
/// with weights 1/std^2 (all 1 if any std is not positive) and errors e_k = phi e_(k-1) + white (Prais, Winsten 1954).
/// phi is found from the residuals of ordinary least squares, about the one step that fits best, with the small-sample
/// correction of Kendall (1954) extended to p regressors, and is at least `least_correlation`, which the caller knows
/// from how the values came about (0 for values that share no data). Degrees of freedom count effective values
/// n (1 - phi)/(1 + phi), at least 2, because phi itself is only estimated. Empty coefficients if the columns are not
/// independent, or if there are fewer values than columns and three more.
CorrelatedFit FitCorrelated(const std::vector<std::vector<double>>& x, const std::vector<double>& y,
                            const std::vector<double>& std, double least_correlation);

/// Means of the first and the last third of a series and their difference.
struct ThirdsComparison {
  double first = 0, last = 0;  ///< weighted means
  double first_std = 0;        ///< of `first`
  TestedValue change;          ///< last minus first
  double correlation = 0;      ///< of successive values, used for the error
  std::size_t count = 0;       ///< values per third
};

/// Compares the last third of `y` with the first. The scatter and the correlation of successive values are
/// taken from differences over one and two values, so a change over the record does not hide in its own
/// error; the error of one value is never below its stated standard deviation `std` (0 or NaN: unknown). The
/// correlation is that of what is left beside a line and a step, or beside two lines where these describe the values far
/// better. A drift of a still other course looks like strongly correlated errors; it is told from them by its second
/// differences, which are small against it: where `least_correlation` is 0, the clearer of the two judgements counts.
/// The change is unknown below 6 values.
ThirdsComparison CompareThirds(const std::vector<double>& y, const std::vector<double>& std,
                               double least_correlation);

/// Squared correlation coefficient, 0 if one of them does not vary.
double SquaredCorrelation(const std::vector<double>& a, const std::vector<double>& b);

}  // namespace hydroscope
