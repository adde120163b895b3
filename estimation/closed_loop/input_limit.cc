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
constexpr double kSharesBelow[] = {0.01, 0.02, 0.05, 0.1, 0.2, 0.35, 0.5};
// Readings exactly at an end, and so many times those within a two-hundredth of it: the peaks of a sine have as many there.
constexpr std::size_t kFewestAtEnd = 30;
constexpr std::size_t kTimesNearEnd = 5;
constexpr double kNearEnd = 0.005;

/// Log likelihood of what is left, up to a constant.
double LikelihoodOf(const LoopSpectra& spectra, const std::vector<std::size_t>& used) {
  double sum = 0;
  for (const std::size_t bin : used) {
    const LoopSums& sums = spectra.bins[bin];
    sum -= std::log(std::max(sums.Residual(sums.Ratio()), 1e-12 * sums.yy));
  }
  return sum * spectra.segments * kIndependentShareOfSegment;
}

/// The same when only a part of the input reaches the plant.
double LikelihoodWith(const FrequencyRecord& record, const LoopSpectraOptions& options,
                      const std::vector<std::size_t>& used) {
  const auto spectra = AverageLoopSpectra(record, options);
  return spectra ? LikelihoodOf(*spectra, used) : -std::numeric_limits<double>::infinity();
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
  const auto likelihood = [&](double limit) {
    LoopSpectraOptions cut_off = same;
    cut_off.limit = limit;
    return LikelihoodWith(record, cut_off, used);
  };
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

std::optional<double> FindDeadBand(const FrequencyRecord& record, const LoopSpectraOptions& options,
                                   const LoopSpectra& spectra, const std::vector<std::size_t>& used) {
  const std::vector<double> magnitudes = SortedMagnitudes(record);
  LoopSpectraOptions same = options;
  same.segment_length = spectra.segment_length;
  const auto likelihood = [&](double dead_band) {
    LoopSpectraOptions without = same;
    without.dead_band = dead_band;
    return LikelihoodWith(record, without, used);
  };
  std::vector<double> bands;
  for (const double share : kSharesBelow)
    bands.push_back(magnitudes[share * static_cast<double>(magnitudes.size() - 1)]);
  const double none = LikelihoodOf(spectra, used);
  double best = likelihood(bands.front());
  if (best < none + kLikelierThanNone)
    return std::nullopt;  // a part of the true one is likelier than none, too
  std::size_t at = 0;
  while (at + 1 < bands.size()) {
    const double next = likelihood(bands[at + 1]);
    if (next <= best) break;
    best = next;
    ++at;
  }
  const double low = at == 0 ? 0 : bands[at - 1], high = bands[std::min(at + 1, bands.size() - 1)];
  // As shares: the search has an absolute tolerance beside the relative one.
  return high * boost::math::tools::brent_find_minima([&](double share) { return -likelihood(share * high); },
                                                      low / high, 1.0, kBitsOfLimit)
                    .first;
}

std::optional<double> FindEndOfReadings(const FrequencyRecord& record) {
  double end = 0;
  for (const SignalRun& run : record.runs)
    for (const double u : run.input) end = std::max(end, std::abs(u));
  std::size_t at = 0, near = 0;
  for (const SignalRun& run : record.runs)
    for (const double u : run.input) {
      at += std::abs(u) == end;
      near += std::abs(u) < end && std::abs(u) > (1 - kNearEnd) * end;
    }
  if (at < kFewestAtEnd || at < kTimesNearEnd * near) return std::nullopt;
  return end;
}

}  // namespace hydroscope
