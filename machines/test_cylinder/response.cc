#include "machines/test_cylinder/response.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/constants.h"

namespace hydroscope {

std::complex<double> TestCylinderResponse(std::complex<double> s, std::span<const double> parameters,
                                          std::span<const double> geometry) {
  const double w_h = kTwoPi * parameters[0], zeta_h = parameters[1], w_sv = kTwoPi * parameters[2];
  const double gain = parameters[3] / geometry[0];
  const std::complex<double> r = s / w_h;
  return gain / (s * (r * r + 2 * zeta_h * r + 1.0) * (s / w_sv + 1.0));
}

bool ShareOutPoles(std::span<double> parameters, int way) {
  double &f_h = parameters[0], &zeta_h = parameters[1], &f_sv = parameters[2];
  if (!(zeta_h >= 1)) return way == 0;
  if (way < 0 || way > 2) return false;
  const double apart = std::sqrt(zeta_h * zeta_h - 1);
  const std::array<double, 3> poles = {f_h * (zeta_h - apart), f_h * (zeta_h + apart), f_sv};
  struct Shares {
    double zeta_h, f_h, f_sv;
  };
  std::array<Shares, 3> ways;
  for (std::size_t k = 0; k < ways.size(); ++k) {
    const double a = poles[(k + 1) % 3], b = poles[(k + 2) % 3];
    ways[k] = {(a + b) / (2 * std::sqrt(a * b)), std::sqrt(a * b), poles[k]};
  }
  std::sort(ways.begin(), ways.end(), [](const Shares& a, const Shares& b) { return a.zeta_h < b.zeta_h; });
  const Shares& chosen = ways[static_cast<std::size_t>(way)];
  zeta_h = chosen.zeta_h;
  f_h = chosen.f_h;
  f_sv = chosen.f_sv;
  return true;
}

}  // namespace hydroscope
