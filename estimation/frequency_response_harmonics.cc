#include "estimation/frequency_response_harmonics.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

namespace hydroscope {
namespace {

using Complex = std::complex<double>;

/// sum_n exp(i angle_n) for angle_n = first + step n, n = 0 ... samples-1.
Complex SumOfPhasors(double first, double step, std::size_t samples) {
  const double n = static_cast<double>(samples);
  const double denominator = std::sin(step / 2);
  if (std::abs(denominator) < 1e-12) return std::polar(n, first);
  return std::polar(std::sin(step * n / 2) / denominator, first + step * (n - 1) / 2);
}

/// b_k = sum_n x_n exp(-i k theta_n), k = 0 ... harmonics; the phasor is turned on by multiplication and set
/// anew every 512 samples so that rounding does not pile up.
std::vector<Complex> Correlate(std::span<const double> signal, double mean, double omega, double phase,
                               int harmonics) {
  constexpr std::size_t kRestart = 512;
  std::vector<Complex> sums(harmonics + 1, 0.0);
  const double cos_step = std::cos(omega), sin_step = std::sin(omega);
  for (std::size_t start = 0; start < signal.size(); start += kRestart) {
    const std::size_t stop = std::min(start + kRestart, signal.size());
    const double angle = phase + omega * static_cast<double>(start);
    double c = std::cos(angle), s = std::sin(angle);
    double re[4] = {0, 0, 0, 0}, im[4] = {0, 0, 0, 0};
    for (std::size_t n = start; n < stop; ++n) {
      const double x = signal[n] - mean;
      const double c2 = c * c - s * s, s2 = 2 * c * s;
      re[0] += x;
      re[1] += x * c;
      im[1] -= x * s;
      re[2] += x * c2;
      im[2] -= x * s2;
      re[3] += x * (c2 * c - s2 * s);
      im[3] -= x * (s2 * c + c2 * s);
      const double next = c * cos_step - s * sin_step;
      s = s * cos_step + c * sin_step;
      c = next;
    }
    for (int k = 0; k <= harmonics; ++k) sums[k] += Complex(re[k], im[k]);
  }
  return sums;
}

}  // namespace

double HarmonicFit::Distortion() const {
  if (coefficients.size() < 3) return std::numeric_limits<double>::quiet_NaN();
  double power = 0;
  for (std::size_t k = 2; k < coefficients.size(); ++k) {
    power += std::norm(coefficients[k]) - residual_variance / static_cast<double>(samples);
  }
  return std::sqrt(std::max(power, 0.0) / std::norm(coefficients[1]));
}

double HarmonicFit::DistortionStd() const {
  return std::sqrt(residual_variance / static_cast<double>(samples) / std::norm(coefficients[1]));
}

int HarmonicsFor(double omega, std::size_t samples, int limit) {
  int harmonics = std::min(limit, 3);
  while (harmonics > 0 && (harmonics * omega > 0.9 * std::numbers::pi ||
                           samples < static_cast<std::size_t>(3 * (2 * harmonics + 1)))) {
    --harmonics;
  }
  return harmonics;
}

HarmonicFit FitHarmonics(std::span<const double> signal, double omega, double phase, int harmonics) {
  const std::size_t samples = signal.size();
  const double mean = std::accumulate(signal.begin(), signal.end(), 0.0) / static_cast<double>(samples);
  const std::vector<Complex> sums = Correlate(signal, mean, omega, phase, harmonics);

  // Normal equations in the basis exp(i k theta), k = -H ... H: a Hermitian Toeplitz matrix known in closed
  // form.
  const int size = 2 * harmonics + 1;
  std::vector<Complex> toeplitz(2 * size);
  for (int m = 0; m < size; ++m) toeplitz[m] = SumOfPhasors(m * phase, m * omega, samples);
  Eigen::MatrixXcd normal(size, size);
  Eigen::VectorXcd right(size);
  for (int j = 0; j < size; ++j) {
    const int order = j - harmonics;
    right(j) = order >= 0 ? sums[order] : std::conj(sums[-order]);
    for (int k = 0; k < size; ++k) normal(j, k) = k >= j ? toeplitz[k - j] : std::conj(toeplitz[j - k]);
  }
  const Eigen::VectorXcd solution = normal.ldlt().solve(right);

  HarmonicFit fit;
  fit.samples = samples;
  for (int k = 0; k <= harmonics; ++k) fit.coefficients.push_back(solution(harmonics + k));
  double power = 0;
  for (double x : signal) power += (x - mean) * (x - mean);
  const double explained = right.dot(solution).real();
  const double freedom = std::max(1.0, static_cast<double>(samples) - size);
  fit.residual_variance = std::max(0.0, power - explained) / freedom;
  fit.coefficients[0] += mean;
  return fit;
}

}  // namespace hydroscope
