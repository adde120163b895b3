#include "diagnosis/drift/operating_class.h"

#include <algorithm>
#include <cmath>

#include "diagnosis/drift/drift_thresholds.h"

namespace hydroscope::drift {
namespace {

constexpr double kLeastOfAll = 1e-12;  ///< SI, for conditions without a least size: nothing is at zero

}  // namespace

OperatingClasses::Features OperatingClasses::FeaturesOf(const WatchedModel& model, const StrokeEvidence& s) {
  Features features;
  const std::vector<Condition>& conditions = model.conditions();
  for (std::size_t c = 0; c < conditions.size(); ++c) {
    const double x = std::isfinite(s.conditions[c]) ? std::abs(s.conditions[c]) : 0.0;
    features.push_back(std::log(std::max({x, conditions[c].least, kLeastOfAll})));
  }
  return features;
}

int OperatingClasses::Find(const WatchedModel& model, const StrokeEvidence& stroke) const {
  const Features features = FeaturesOf(model, stroke);
  int nearest = -1;
  double least = kDriftThresholds.class_radius * kDriftThresholds.class_radius;
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

int OperatingClasses::FindOrAdd(const WatchedModel& model, const StrokeEvidence& stroke) {
  const int found = Find(model, stroke);
  if (found >= 0 || count() >= kMostClasses) return found;
  centres_.push_back(FeaturesOf(model, stroke));
  return count() - 1;
}

bool OperatingClasses::Encloses(const WatchedModel& model, const StrokeEvidence& stroke) const {
  const Features features = FeaturesOf(model, stroke);
  for (std::size_t f = 0; f < features.size(); ++f) {
    const auto between = [f](const Features& a, const Features& b) { return a[f] < b[f]; };
    const auto [low, high] = std::minmax_element(centres_.begin(), centres_.end(), between);
    if (low == centres_.end() || features[f] < (*low)[f] - kDriftThresholds.class_radius ||
        features[f] > (*high)[f] + kDriftThresholds.class_radius)
      return false;
  }
  return true;
}

void OperatingClasses::Save(ByteWriter& out) const {
  out.Put<std::uint32_t>(static_cast<std::uint32_t>(centres_.size()));
  for (const Features& centre : centres_) {
    out.Put<std::uint32_t>(static_cast<std::uint32_t>(centre.size()));
    for (const double feature : centre) out.Put(feature);
  }
}

bool OperatingClasses::Restore(ByteReader& in) {
  centres_.clear();
  const auto size = in.Get<std::uint32_t>();
  if (size > kMostClasses) return false;
  for (std::uint32_t c = 0; c < size && in.ok(); ++c) {
    const auto features = in.Get<std::uint32_t>();
    if (features > kMaxConditions) return false;
    centres_.emplace_back(features);
    for (double& feature : centres_.back()) feature = in.Get<double>();
  }
  return in.ok();
}

}  // namespace hydroscope::drift
