#pragma once

#include <string>

namespace hydroscope {

struct SealFrictionOptions {
  /// Folder with X-ring257_*bar.csv; "" = seal_friction in HYDROSCOPE_DATA or ../shared/data.
  std::string data;
  std::string machine = "machines/seal_friction.toml";
};

/// The measured runs of a cylinder seal at four pressures, explained together from F = A p + c: which effects
/// are named, the error before and after on strokes and on pressures left out, and the bore that follows from
/// A. Returns 0 if Coulomb and pressure-dependent friction are named, the error falls below a quarter, and
/// the bore comes out at 25.7 mm within 0.2 mm; else 1. Without the data it says so and returns 3.
int RunSealFriction(const SealFrictionOptions& options);

}  // namespace hydroscope
