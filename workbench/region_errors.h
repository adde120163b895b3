#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/result.h"
#include "diagnosis/remainder/residuals.h"

namespace hydroscope {

/// A part of the operating space: ranges of signals in the units that maps show them in.
struct RegionRange {
  std::string signal;
  double from = 0, to = 0;
};
using Region = std::vector<RegionRange>;

/// Sums over the windows of a region, output unit squared.
struct RegionSums {
  double windows = 0, error = 0, noise = 0;

  void Add(const RegionSums& other);
  /// Output unit; 0 without windows.
  double Rms() const;
  double NoiseRms() const;
};

/// What a model with one more effect gives: per stroke, per window, output unit.
struct ModelledWithEffect {
  std::string effect;
  std::vector<std::vector<double>> modelled;
};

struct ErrorsInRegion {
  RegionSums all;
  std::vector<std::pair<std::int64_t, RegionSums>> by_stroke;  ///< those with windows in the region
  std::vector<std::pair<std::string, double>> with_effect;     ///< rms with one more effect, least first
};

/// Of `residuals`, whose strokes have the numbers `strokes`: pieces of an episode follow one another and are one. Error: the
/// region names a signal that is not looked at.
Result<ErrorsInRegion> ErrorsIn(const Region& region, const Residuals& residuals,
                                std::span<const std::int64_t> strokes,
                                std::span<const ModelledWithEffect> effects);

}  // namespace hydroscope
