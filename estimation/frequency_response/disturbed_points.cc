#include "estimation/frequency_response/disturbed_points.h"

#include <algorithm>

#include "estimation/frequency_response/model.h"

namespace hydroscope {
namespace {

constexpr double kMisfit = 3;  // of all points, in noise, that asks for a cause
constexpr double kWeak = 0.5;  // of the median amplitude of the command, below which a point may be left out
constexpr double kFar = 25;    // squared distance from the model, in the variance of the others' misfit
constexpr double kMostLeftOut = 0.2;  // of the points
constexpr double kBetter = 0.5;       // misfit of what remains, in that of all
constexpr int kRounds = 10;
constexpr int kFewestWithOneOff = 8;  // points used, so that one of them is one among many

/// Points used whose command is weak.
std::vector<FrequencyPoint*> WeakPoints(std::vector<FrequencyPoint>& points) {
  std::vector<double> amplitudes;
  for (const FrequencyPoint& p : points)
    if (p.reason == PointReason::kUsed) amplitudes.push_back(p.amplitude);
  if (amplitudes.empty()) return {};
  const auto middle = amplitudes.begin() + std::ssize(amplitudes) / 2;
  std::nth_element(amplitudes.begin(), middle, amplitudes.end());
  std::vector<FrequencyPoint*> weak;
  for (FrequencyPoint& p : points)
    if (p.reason == PointReason::kUsed && p.amplitude < kWeak * *middle) weak.push_back(&p);
  return weak;
}

/// The point lies far from the model of the others.
bool Far(const FrequencyPoint& p, const ValveModel& model) {
  const double variances = 2 * kFar * model.inflation * model.inflation;
  return std::norm(p.response - model.Response(p.frequency)) > variances * p.variance;
}

/// Leaves out the weak points that the model is far from, and takes the others; true if that changed any.
bool Sort(const std::vector<FrequencyPoint*>& weak, const ValveModel& model) {
  bool changed = false;
  for (FrequencyPoint* p : weak) {
    const PointReason reason = Far(*p, model) ? PointReason::kDisturbed : PointReason::kUsed;
    changed = changed || reason != p->reason;
    p->reason = reason;
  }
  return changed;
}

}  // namespace

std::optional<ValveModel> FitWithoutDisturbed(std::vector<FrequencyPoint>& points, const ValveModel& of_all,
                                              double correlation, double sample_period) {
  if (!(of_all.inflation > kMisfit)) return std::nullopt;
  const auto used =
      std::ranges::count_if(points, [](const auto& p) { return p.reason == PointReason::kUsed; });
  std::vector<FrequencyPoint> trial = points;
  const std::vector<FrequencyPoint*> weak = WeakPoints(trial);
  for (FrequencyPoint* p : weak) p->reason = PointReason::kDisturbed;
  auto model = FitValveModel(trial, correlation, sample_period);
  for (int round = 0; round < kRounds && model && Sort(weak, *model); ++round)
    model = FitValveModel(trial, correlation, sample_period);
  const auto left_out =
      std::ranges::count_if(weak, [](const auto* p) { return p->reason == PointReason::kDisturbed; });
  const bool few = static_cast<double>(left_out) <= kMostLeftOut * static_cast<double>(used);
  if (!model || left_out == 0 || !few || model->inflation > kBetter * of_all.inflation) return std::nullopt;
  points = std::move(trial);
  return *model;
}

std::optional<ValveModel> FitWithoutOne(std::vector<FrequencyPoint>& points, const ValveModel& of_all,
                                        double sample_period) {
  const auto used =
      std::ranges::count_if(points, [](const auto& p) { return p.reason == PointReason::kUsed; });
  if (!(of_all.inflation > kMisfit) || used < kFewestWithOneOff) return std::nullopt;
  std::optional<ValveModel> best;
  FrequencyPoint* off = nullptr;
  for (FrequencyPoint& p : points) {
    if (p.reason != PointReason::kUsed) continue;
    p.reason = PointReason::kOffTheOthers;
    const auto model = FitValveModel(points, 1, sample_period, of_all.command_hold > 0, &of_all);
    p.reason = PointReason::kUsed;
    if (!model || (best && model->inflation >= best->inflation)) continue;
    best = *model;
    off = &p;
  }
  if (!best || best->inflation > kMisfit || best->inflation > kBetter * of_all.inflation || !Far(*off, *best))
    return std::nullopt;
  const auto bends = [&](const FrequencyPoint& p) {
    return &p != off && p.reason == PointReason::kUsed && p.OwnDistortion() > 0;
  };
  if (std::ranges::any_of(points, bends)) return std::nullopt;
  off->reason = PointReason::kOffTheOthers;
  return best;
}

}  // namespace hydroscope
