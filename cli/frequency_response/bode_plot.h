#pragma once

#include <complex>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "estimation/frequency_response/frequency_response.h"

namespace hydroscope {

inline constexpr double kHalfPower = 3.0103;  ///< dB
double Decibels(double gain);

/// Measured points and a model's curve over frequency.
struct BodePicture {
  std::vector<const FrequencyPoint*> points = {};             ///< in order of frequency, at least one
  std::function<std::complex<double>(double)> response = {};  ///< of Hz; empty: no curve
  std::function<double(double)> phase = {};                   ///< rad, without jumps
  std::optional<double> gain_level = {};  ///< dB, a line across; nothing: 3 dB below the first point
  std::string title = "", legend = "", gain_label = "gain (dB)";
};

/// As a self-contained SVG that follows the reader's light or dark theme.
std::string BodePlot(const BodePicture& picture);

}  // namespace hydroscope
