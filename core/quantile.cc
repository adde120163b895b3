#include "core/quantile.h"

#include <algorithm>
#include <cmath>

namespace hydroscope {
namespace {

void KeepNumbers(std::vector<double>& values) {
  std::erase_if(values, [](double v) { return std::isnan(v); });
}

}  // namespace

double Quantile(std::vector<double> values, double share, double none) {
  KeepNumbers(values);
  if (values.empty()) return none;
  const auto place =
      values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), place, values.end());
  return *place;
}

double Median(std::vector<double> values, double none) {
  KeepNumbers(values);
  if (values.empty()) return none;
  const auto middle = values.begin() + values.size() / 2;
  std::nth_element(values.begin(), middle, values.end());
  if (values.size() % 2 == 1) return *middle;
  return (*middle + *std::max_element(values.begin(), middle)) / 2;
}

}  // namespace hydroscope
