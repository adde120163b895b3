#include "diagnosis/drift/operating_class.h"

#include <algorithm>
#include <cmath>

namespace hydroscope::drift {

OperatingClasses::Features OperatingClasses::FeaturesOf(const StrokeEvidence& s) {
  const auto logarithm = [](double x, double least) { return std::log(std::max(std::abs(x), least)); };
  return {logarithm(s.speed, 1e-4), logarithm(s.mean_pressure, 1e4), logarithm(s.max_pressure, 1e4)};
}

int OperatingClasses::Find(const StrokeEvidence& stroke) const {
  const Features features = FeaturesOf(stroke);
  int nearest = -1;
  double least = kRadius * kRadius;
  for (int c = 0; c < count(); ++c) {
    double square = 0;
    for (std::size_t f = 0; f < features.size(); ++f) square += std::pow(features[f] - centres_[c][f], 2);
    if (square <= least) {
      least = square;
      nearest = c;
    }
  }
  return nearest;
}

int OperatingClasses::FindOrAdd(const StrokeEvidence& stroke) {
  const int found = Find(stroke);
  if (found >= 0 || count() >= kMostClasses) return found;
  centres_.push_back(FeaturesOf(stroke));
  return count() - 1;
}

bool OperatingClasses::Encloses(const StrokeEvidence& stroke) const {
  const Features features = FeaturesOf(stroke);
  for (std::size_t f = 0; f < features.size(); ++f) {
    const auto between = [f](const Features& a, const Features& b) { return a[f] < b[f]; };
    const auto [low, high] = std::minmax_element(centres_.begin(), centres_.end(), between);
    if (low == centres_.end() || features[f] < (*low)[f] - kRadius || features[f] > (*high)[f] + kRadius)
      return false;
  }
  return true;
}

double OperatingClasses::speed(int index) const { return std::exp(centres_[index][0]); }
double OperatingClasses::pressure(int index) const { return std::exp(centres_[index][1]); }

void OperatingClasses::Save(ByteWriter& out) const {
  out.Put<std::uint32_t>(static_cast<std::uint32_t>(centres_.size()));
  for (const Features& centre : centres_) out.Put(centre);
}

bool OperatingClasses::Restore(ByteReader& in) {
  centres_.clear();
  const auto size = in.Get<std::uint32_t>();
  if (size > kMostClasses) return false;
  for (std::uint32_t c = 0; c < size && in.ok(); ++c) centres_.push_back(in.Get<Features>());
  return in.ok();
}

}  // namespace hydroscope::drift
