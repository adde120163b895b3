#include "diagnosis/drift/class_offset.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/distributions.h"
#include "core/quantile.h"
#include "diagnosis/drift/drift_thresholds.h"

namespace hydroscope::drift {
namespace {

constexpr std::size_t kBlock = 10;      ///< strokes, for the correlation of neighbours
constexpr double kClip = 3.5;           ///< standard deviations, against single bad strokes
constexpr double kMedianLoss = 1.2533;  ///< std of a median over that of a mean, normal distribution

/// Where half of the information lies on either side.
double WeightedMedian(std::span<const ClassDeviation> strokes) {
  std::vector<ClassDeviation> sorted(strokes.begin(), strokes.end());
  std::sort(sorted.begin(), sorted.end(), [](const auto& a, const auto& b) { return a.value < b.value; });
  double all = 0, passed = 0;
  for (const ClassDeviation& s : sorted) all += s.information;
  for (const ClassDeviation& s : sorted)
    if ((passed += s.information) >= all / 2) return s.value;
  return sorted.back().value;
}

struct Weighted {
  double mean = 0, weight = 0, squares = 0;
};

/// Mean of the offsets with this variance between classes, and their weighted squares about it.
Weighted MeanWith(std::span<const ClassOffset> classes, double variance) {
  Weighted w;
  for (const ClassOffset& c : classes) {
    const double weight = 1 / (c.std * c.std + variance);
    w.weight += weight;
    w.mean += weight * c.offset;
  }
  w.mean /= w.weight;
  for (const ClassOffset& c : classes)
    w.squares += (c.offset - w.mean) * (c.offset - w.mean) / (c.std * c.std + variance);
  return w;
}

}  // namespace

double Scatter(const std::vector<double>& standardised) {
  if (standardised.empty()) return 1;
  std::vector<double> sizes;
  for (const double z : standardised) sizes.push_back(std::abs(z));
  std::nth_element(sizes.begin(), sizes.begin() + static_cast<long>(sizes.size() / 2), sizes.end());
  const double scale = std::max(sizes[sizes.size() / 2] / kNormalMedianMagnitude, 1e-12);
  double single = 0, blocks = 0, block = 0;
  std::size_t count = 0;
  for (std::size_t k = 0; k < standardised.size(); ++k) {
    const double z = std::clamp(standardised[k], -kClip * scale, kClip * scale);
    single += z * z;
    block += z;
    if ((k + 1) % kBlock == 0) {
      blocks += block * block / kBlock;
      block = 0;
      ++count;
    }
  }
  single /= static_cast<double>(standardised.size());
  const double scatter = count >= 5 ? std::max(single, blocks / static_cast<double>(count)) : single;
  return std::max(scatter, 1e-300);
}

ClassOffset MeasureOffset(std::span<const ClassDeviation> strokes, double scatter) {
  ClassOffset offset{0, std::numeric_limits<double>::infinity(), scatter > 0 ? scatter : 1};
  double information = 0;
  for (const ClassDeviation& s : strokes) information += s.information;
  if (!(information > 0)) return offset;
  offset.offset = WeightedMedian(strokes);
  if (!(scatter > 0)) {
    std::vector<double> standardised;
    for (const ClassDeviation& s : strokes)
      standardised.push_back((s.value - offset.offset) * std::sqrt(s.information));
    offset.scatter = Scatter(standardised);
  }
  offset.std = kMedianLoss * std::sqrt(offset.scatter / information);
  return offset;
}

void TemperatureRange::Take(double temperature) {
  if (!std::isfinite(temperature)) return;
  low = std::min(low, temperature);
  high = std::max(high, temperature);
}

double TemperatureRange::Nearest(double temperature) const {
  return std::isfinite(temperature) && high >= low ? std::clamp(temperature, low, high) : temperature;
}

OffsetSpread SpreadOf(std::span<const ClassOffset> classes) {
  std::vector<ClassOffset> known;
  for (const ClassOffset& c : classes)
    if (std::isfinite(c.std) && c.std > 0) known.push_back(c);
  if (known.empty()) return {0, 0, std::numeric_limits<double>::infinity()};
  if (known.size() == 1) return {known[0].offset, known[0].std, std::numeric_limits<double>::infinity()};
  const double degrees = static_cast<double>(known.size() - 1);
  const double least = ChiSquaredQuantile(kDriftThresholds.unlikely_offset, degrees);
  // The weighted squares fall steadily with the variance: bisection on its logarithm.
  double low = std::numeric_limits<double>::infinity(), high = 0;
  for (const ClassOffset& c : known) {
    low = std::min(low, c.std * c.std);
    high = std::max(high, c.std * c.std + c.offset * c.offset);
  }
  low *= 1e-6;
  high *= 1e6;
  if (MeanWith(known, low).squares > least)
    for (int step = 0; step < 100; ++step) {
      const double middle = std::sqrt(low * high);
      (MeanWith(known, middle).squares > least ? low : high) = middle;
    }
  const Weighted at = MeanWith(known, low);
  return {at.mean, 1 / std::sqrt(at.weight), std::sqrt(low)};
}

ClassOffset Combine(const ClassOffset& measured, const OffsetSpread& prior) {
  const double variance = prior.std * prior.std + prior.mean_std * prior.mean_std;
  if (!std::isfinite(variance) || !(variance > 0)) return measured;
  if (!std::isfinite(measured.std)) return {prior.mean, std::sqrt(variance), measured.scatter};
  const double share = variance / (variance + measured.std * measured.std);
  return {prior.mean + share * (measured.offset - prior.mean), std::sqrt(share) * measured.std,
          measured.scatter};
}

}  // namespace hydroscope::drift
