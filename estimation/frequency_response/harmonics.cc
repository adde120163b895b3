#include "estimation/frequency_response/harmonics.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

namespace hydroscope {
namespace {

using Complex = std::complex<double>;

constexpr int kMostUnknowns = 2 * HarmonicFit::kMostHarmonics + 1;
constexpr double kRounding = 1e-12;  // of a sine that is 0
// rad per sample: a harmonic nearer to half the sampling rate is not fitted.
constexpr double kHighest = 0.9 * std::numbers::pi;
constexpr std::size_t kStride = 16;  // samples between two running sums

/// sum_n exp(i m (phase + omega n)), n = 0 ... samples - 1, for m = 0 ... last, in closed form:
/// sin(m omega samples / 2) / sin(m omega / 2) exp(i m (phase + omega (samples - 1) / 2)).
std::array<Complex, kMostUnknowns> SumsOfPhasors(double phase, double omega, std::size_t samples, int last) {
  const double n = static_cast<double>(samples);
  const Complex whole = std::polar(1.0, omega * n / 2), half = std::polar(1.0, omega / 2);
  const Complex middle = std::polar(1.0, phase + omega * (n - 1) / 2);
  std::array<Complex, kMostUnknowns> sums{n};
  Complex whole_m = whole, half_m = half, middle_m = middle;
  for (int m = 1; m <= last; ++m) {
    // A multiple of the sampling rate: all terms are alike.
    const bool alike = std::abs(half_m.imag()) < kRounding;
    sums[m] = alike ? std::polar(n, m * phase) : whole_m.imag() / half_m.imag() * middle_m;
    whole_m *= whole;
    half_m *= half;
    middle_m *= middle;
  }
  return sums;
}

double Mean(std::span<const double> signal) {
  return std::accumulate(signal.begin(), signal.end(), 0.0) / static_cast<double>(signal.size());
}

constexpr std::size_t kRestart = 512;  // samples after which rounding of a turned phasor begins to pile up

/// Adds the samples of `signal` less `offset` to `sums`, from the phasor's angle on.
void Correlate(std::span<const double> signal, double offset, Phasor& phasor, HarmonicSums& sums) {
  double square = 0;
  double re[4] = {0, 0, 0, 0}, im[4] = {0, 0, 0, 0};
  for (const double sample : signal) {
    const double x = sample - offset, c = phasor.c, s = phasor.s;
    const double c2 = c * c - s * s, s2 = 2 * c * s;
    square += x * x;
    re[0] += x;
    re[1] += x * c;
    im[1] -= x * s;
    re[2] += x * c2;
    im[2] -= x * s2;
    re[3] += x * (c2 * c - s2 * s);
    im[3] -= x * (s2 * c + c2 * s);
    phasor.Turn();
  }
  for (int k = 0; k <= HarmonicFit::kMostHarmonics; ++k) sums.correlation[k] += Complex(re[k], im[k]);
  sums.square += square;
}

/// Normal equations in the basis 1, cos k theta, sin k theta, k = 1 ... H: known in closed form and the same
/// for every signal over the same samples.
class HarmonicBasis {
 public:
  HarmonicBasis(double omega, double phase, std::size_t samples, int harmonics)
      : harmonics_(harmonics), samples_(samples) {
    const auto sum = SumsOfPhasors(phase, omega, samples, 2 * harmonics);
    const auto at = [&](int m) { return m >= 0 ? sum[m] : std::conj(sum[-m]); };
    Matrix normal = Matrix::Zero(size(), size());
    for (int j = 0; j <= harmonics; ++j) {
      for (int k = 0; k <= harmonics; ++k) {
        normal(Cosine(j), Cosine(k)) = (at(j - k) + at(j + k)).real() / 2;
        if (k > 0)
          normal(Cosine(j), Sine(k)) = normal(Sine(k), Cosine(j)) = (at(j + k) + at(k - j)).imag() / 2;
        if (j > 0 && k > 0) normal(Sine(j), Sine(k)) = (at(j - k) - at(j + k)).real() / 2;
      }
    }
    factor_.compute(normal);
  }

  /// `sums` of the samples less `offset`.
  HarmonicFit Fit(const HarmonicSums& sums, double offset) const {
    Vector right(size());
    for (int k = 0; k <= harmonics_; ++k) {
      right(Cosine(k)) = sums.correlation[k].real();
      if (k > 0) right(Sine(k)) = -sums.correlation[k].imag();
    }
    const Vector solution = factor_.solve(right);
    HarmonicFit fit;
    fit.harmonics = harmonics_;
    fit.samples = samples_;
    fit.coefficients[0] = solution(0) + offset;
    for (int k = 1; k <= harmonics_; ++k) {
      fit.coefficients[k] = Complex(solution(Cosine(k)), -solution(Sine(k))) / 2.0;
    }
    const double freedom = std::max(1.0, static_cast<double>(samples_) - size());
    fit.residual_variance = std::max(0.0, sums.square - right.dot(solution)) / freedom;
    return fit;
  }

 private:
  using Matrix =
      Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMostUnknowns, kMostUnknowns>;
  using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMostUnknowns, 1>;

  int size() const { return 2 * harmonics_ + 1; }
  static int Cosine(int k) { return k == 0 ? 0 : 2 * k - 1; }
  static int Sine(int k) { return 2 * k; }

  int harmonics_;
  std::size_t samples_;
  Eigen::LLT<Matrix> factor_;
};

}  // namespace

double HarmonicFit::Distortion() const {
  if (harmonics < 2) return std::numeric_limits<double>::quiet_NaN();
  double power = 0;
  for (int k = 2; k <= harmonics; ++k) {
    power += std::norm(coefficients[k]) - residual_variance / static_cast<double>(samples);
  }
  return std::sqrt(std::max(power, 0.0) / std::norm(coefficients[1]));
}

double HarmonicFit::DistortionStd() const {
  return std::sqrt(residual_variance / static_cast<double>(samples) / std::norm(coefficients[1]));
}

int HarmonicsFor(double omega, std::size_t samples) {
  int harmonics = HarmonicFit::kMostHarmonics;
  while (harmonics > 0 &&
         (harmonics * omega > kHighest || samples < static_cast<std::size_t>(3 * (2 * harmonics + 1)))) {
    --harmonics;
  }
  return harmonics;
}

HarmonicFit FitHarmonics(std::span<const double> signal, double omega, double phase, int harmonics) {
  const double mean = Mean(signal);
  HarmonicSums sums;
  Phasor phasor(omega);
  for (std::size_t start = 0; start < signal.size(); start += kRestart) {
    phasor.Set(phase + omega * static_cast<double>(start));
    Correlate(signal.subspan(start, std::min(kRestart, signal.size() - start)), mean, phasor, sums);
  }
  return HarmonicBasis(omega, phase, signal.size(), harmonics).Fit(sums, mean);
}

HeldSineSums::HeldSineSums(std::span<const double> input, std::span<const double> output, double omega,
                           std::size_t begin, std::size_t end)
    : omega_(omega), phasor_(omega), begin_(begin) {
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    Channel& channel = channels_[i];
    channel.signal = i == 0 ? input : output;
    channel.offset = Mean(channel.signal.subspan(begin, end - begin));
    HarmonicSums sums;
    channel.running = {sums};
    Phasor phasor = phasor_;
    for (std::size_t start = begin; start + kStride <= end; start += kStride) {
      if ((start - begin) % kRestart == 0) phasor.Set(omega * static_cast<double>(start));
      Correlate(channel.signal.subspan(start, kStride), channel.offset, phasor, sums);
      channel.running.push_back(sums);
    }
  }
}

std::array<HarmonicSums, 2> HeldSineSums::UpTo(std::size_t end) const {
  const std::size_t whole = (end - begin_) / kStride, start = begin_ + whole * kStride;
  Phasor at_start = phasor_;
  at_start.Set(omega_ * static_cast<double>(start));
  std::array<HarmonicSums, 2> sums;
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    sums[i] = channels_[i].running[whole];
    Phasor phasor = at_start;
    Correlate(channels_[i].signal.subspan(start, end - start), channels_[i].offset, phasor, sums[i]);
  }
  return sums;
}

HeldSineSums::Fits HeldSineSums::Fit(std::size_t from, std::size_t to) const {
  const std::size_t samples = to - from;
  const HarmonicBasis basis(omega_, omega_ * static_cast<double>(from), samples,
                            HarmonicsFor(omega_, samples));
  const std::array<HarmonicSums, 2> before = UpTo(from);
  std::array<HarmonicSums, 2> sums = UpTo(to);
  for (std::size_t i = 0; i < sums.size(); ++i) {
    for (std::size_t k = 0; k < sums[i].correlation.size(); ++k) {
      sums[i].correlation[k] -= before[i].correlation[k];
    }
    sums[i].square -= before[i].square;
  }
  return {basis.Fit(sums[0], channels_[0].offset), basis.Fit(sums[1], channels_[1].offset)};
}

}  // namespace hydroscope
