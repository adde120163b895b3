#pragma once

#include <complex>
#include <span>

namespace hydroscope {

/// Rod position over valve current, m/A (the paper's eq. 11 to 13):
///
///   Y/I = (K_sv/A) / ( s (s^2/w_h^2 + 2 zeta_h s/w_h + 1) (s/w_sv + 1) ),   w = 2 pi f
///
/// `parameters`: f_h Hz, zeta_h 1, f_sv Hz, K_sv m3/(s A); what follows is not looked at. `geometry`: A m2.
std::complex<double> TestCylinderResponse(std::complex<double> s, std::span<const double> parameters,
                                          std::span<const double> geometry);

/// Three real poles (zeta_h > 1) may be shared out in three ways between oil column and valve, with the same response; `way` 0 is
/// the one with the least zeta_h, the two nearest poles being the oil column's, so that nothing jumps where zeta_h passes 1. False
/// if there is no such way.
bool ShareOutPoles(std::span<double> parameters, int way);

}  // namespace hydroscope
