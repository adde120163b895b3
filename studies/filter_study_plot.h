#pragma once

#include <array>
#include <string>
#include <vector>

#include "core/result.h"

namespace hydroscope {

constexpr int kStudied = 3;  ///< theta1, theta2, theta3

/// Percent of the truth.
struct BiasAndStd {
  std::array<double, kStudied> bias{}, std{};
};

struct FilterStudyResult {
  std::vector<double> width;          ///< M of the first entries of `published`, samples
  std::vector<BiasAndStd> published;  ///< one per width, then the published pair
  BiasAndStd recursive, batch;
};

/// Writes bias and standard deviation over the filter width as one SVG picture, the recursive estimator of
/// the product as a horizontal band. Error: the file cannot be written.
Status WriteFilterStudyPlot(const FilterStudyResult& study, const std::string& path);

}  // namespace hydroscope
