#include "simulator/test_cylinder/coloured_noise.h"

#include <cmath>
#include <complex>

#include "core/constants.h"

namespace hydroscope {
namespace {

using Pole = std::complex<double>;

/// Frequency of the analogue prototype that the bilinear transform puts at `hz`, rad per half sample.
double Warped(double hz, double sample_period) { return std::tan(kTwoPi / 2 * hz * sample_period); }

Pole Bilinear(Pole s) { return (1.0 + s) / (1.0 - s); }

}  // namespace

ColouredNoise ColouredNoise::LowPass(double corner_hz, double sample_period, std::uint64_t seed) {
  const double pole = std::exp(-kTwoPi * corner_hz * sample_period);
  return {{FilterSection({1 - pole, 0, 0}, {-pole, 0})}, seed};
}

ColouredNoise ColouredNoise::BandPass(double low_hz, double high_hz, double sample_period,
                                      std::uint64_t seed) {
  const double low = Warped(low_hz, sample_period), high = Warped(high_hz, sample_period);
  const double width = high - low, centre = low * high;
  std::vector<FilterSection> sections;
  for (int k = 0; k < 2; ++k) {  // poles of order 3 with imaginary part >= 0; each gives two of the band pass
    const Pole prototype = std::polar(1.0, kTwoPi * (2.0 * k + 4) / 12) * width / 2.0;
    const Pole root = std::sqrt(prototype * prototype - centre);
    for (const Pole analogue : {prototype + root, prototype - root}) {
      if (k == 1 && analogue.imag() < 0) continue;  // the real pole's pair is conjugate
      const Pole z = Bilinear(analogue);
      // Zeros at 0 and half the sampling rate; gain 1 in the middle of the band.
      const Pole middle = Bilinear(Pole(0, std::sqrt(centre)));
      const double gain = std::abs((1.0 - z / middle) * (1.0 - std::conj(z) / middle)) /
                          std::abs(1.0 - 1.0 / (middle * middle));
      sections.emplace_back(std::array{gain, 0.0, -gain}, std::array{-2 * z.real(), std::norm(z)});
    }
  }
  return {std::move(sections), seed};
}

double ColouredNoise::Next() {
  double value = random_.Normal();
  for (FilterSection& section : sections_) value = section(value);
  return value;
}

}  // namespace hydroscope
