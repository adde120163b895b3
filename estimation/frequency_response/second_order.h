#pragma once

#include <complex>

#include "core/constants.h"

namespace hydroscope {

using Complex = std::complex<double>;

/// Product without the detour that operator* takes for infinite factors.
inline Complex Times(Complex a, Complex b) {
  return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
}

/// 1 / (1 + 2 D j r - r^2) with r = omega / omega_0.
inline Complex SecondOrder(double omega, double omega_0, double damping) {
  const double r = omega / omega_0, real = 1 - r * r, imaginary = 2 * damping * r;
  const double squared = real * real + imaginary * imaginary;
  return {real / squared, -imaginary / squared};
}

/// Images on either side that a response needs which falls with the square of the frequency.
inline constexpr int kImages = 16;

/// Calls visit(w_m, factor_m), m from -images on, for the terms whose sum is the response between samples: the frequency itself,
/// or for a command held from sample to sample also its images w_m = w + m 2 pi / hold, each through the hold
/// (1 - exp(-j w_m hold)) / (j w_m hold) (Astroem and Wittenmark, Computer-Controlled Systems, 1997, sec. 7.6).
template <typename Visit>
void ForEachImage(double omega, double hold, Visit visit, int images = kImages) {
  if (hold <= 0) {
    visit(omega, Complex(1));
    return;
  }
  const Complex numerator = 1.0 - std::polar(1.0, -omega * hold);
  for (int m = -images; m <= images; ++m) {
    const double image = omega + m * kTwoPi / hold;
    const double per_turn = 1 / (image * hold);
    visit(image, Complex(numerator.imag() * per_turn, -numerator.real() * per_turn));
  }
}

}  // namespace hydroscope
