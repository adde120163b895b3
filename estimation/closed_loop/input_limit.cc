#include "estimation/closed_loop/input_limit.h"

#include <algorithm>
#include <boost/math/tools/minima.hpp>
#include <cmath>

namespace hydroscope {
namespace {

constexpr double kSharesCutOff[] = {0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.35, 0.5};
// Gain in log likelihood. On records of healthy plants it stays below 4 (`hydroscope benchmark test-cylinder`).
constexpr double kLikelierThanNone = 15;
constexpr int kBitsOfLimit = 10;  // a limit to a thousandth is more than the data hold

/// Log likelihood of what is left when the input is cut off at `limit`, up to a constant.
double LikelihoodWithLimit(const FrequencyRecord& record, LoopSpectraOptions options, double limit,
                           const std::vector<std::size_t>& used) {
  options.limit = limit;
  const auto spectra = AverageLoopSpectra(record, options);
  if (!spectra) return -std::numeric_limits<double>::infinity();
  double sum = 0;
  for (const std::size_t bin : used) {
    const LoopSums& sums = spectra->bins[bin];
    sum -= std::log(std::max(sums.Residual(sums.Ratio()), 1e-12 * sums.yy));
  }
  return sum * spectra->segments * kIndependentShareOfSegment;
}

std::vector<double> SortedMagnitudes(const FrequencyRecord& record) {
  std::vector<double> magnitudes;
  for (const SignalRun& run : record.runs)
    for (const double u : run.input) magnitudes.push_back(std::abs(u));
  std::ranges::sort(magnitudes);
  return magnitudes;
}

}  // namespace

std::optional<double> FindInputLimit(const FrequencyRecord& record, const LoopSpectraOptions& options,
                                     const LoopSpectra& spectra, const std::vector<std::size_t>& used) {
  const std::vector<double> magnitudes = SortedMagnitudes(record);
  LoopSpectraOptions same = options;
  same.segment_length = spectra.segment_length;
  const auto likelihood = [&](double limit) { return LikelihoodWithLimit(record, same, limit, used); };
  std::vector<double> limits;
  for (const double share : kSharesCutOff)
    limits.push_back(magnitudes[(1 - share) * static_cast<double>(magnitudes.size() - 1)]);
  std::size_t best = 0;
  std::vector<double> values;
  for (const double limit : limits) values.push_back(likelihood(limit));
  best = static_cast<std::size_t>(std::ranges::max_element(values) - values.begin());
  if (values[best] < likelihood(magnitudes.back()) + kLikelierThanNone) return std::nullopt;
  const double low = limits[std::min(best + 1, limits.size() - 1)];
  const double high = best == 0 ? magnitudes.back() : limits[best - 1];
  return boost::math::tools::brent_find_minima([&](double limit) { return -likelihood(limit); }, low, high,
                                               kBitsOfLimit)
      .first;
}

}  // namespace hydroscope
