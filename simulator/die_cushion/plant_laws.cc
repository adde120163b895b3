#include "simulator/die_cushion/plant_laws.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>

#include "simulator/random.h"

namespace hydroscope {
namespace {

using enum ImperfectionKind;

constexpr double kWarmest = 60;  // K above the reference that the integration step allows for

/// Size of the only imperfection of its kind, 0 if there is none.
double SizeOf(const std::vector<Imperfection>& list, ImperfectionKind kind) {
  const Imperfection* one = FindImperfection(list, kind);
  return one == nullptr ? 0 : one->size;
}

double ExtraOf(const std::vector<Imperfection>& list, ImperfectionKind kind, std::size_t index) {
  const Imperfection* one = FindImperfection(list, kind);
  return one == nullptr ? 0 : one->extras[index];
}

}  // namespace

PlantLaws PlantLawsOf(const std::vector<Imperfection>& list) {
  PlantLaws laws;
  laws.return_line = SizeOf(list, kReturnLineResistance) + ExtraOf(list, kCheckValve, 0);
  laws.tank_shift = SizeOf(list, kTankPressure);
  laws.check_valve = SizeOf(list, kCheckValve);
  laws.laminar_edge = SizeOf(list, kLaminarEdge);
  laws.modulus_slope = SizeOf(list, kBulkModulusSlope);
  laws.relief_square = SizeOf(list, kQuadraticRelief);
  laws.relief_crack = ExtraOf(list, kQuadraticRelief, 0);
  laws.zone_leakage = SizeOf(list, kRectangularZone);
  laws.zone_centre = ExtraOf(list, kRectangularZone, 0);
  laws.zone_width = ExtraOf(list, kRectangularZone, 1);
  laws.supply_leakage = SizeOf(list, kSupplyLeakage);
  laws.second_gain = SizeOf(list, kTwoGainSpool);
  laws.knee = ExtraOf(list, kTwoGainSpool, 0);
  laws.area_error = SizeOf(list, kWrongArea);
  return laws;
}

double PlantLaws::Leakage(double p_A, double p_B, double p_0, double z) const {
  const double above = std::max(0.0, p_A - relief_crack);
  double flow = relief_square * above * above - supply_leakage * SignedRoot(p_0 - p_A);
  if (std::abs(z - zone_centre) < zone_width) flow += zone_leakage * (p_A - p_B);
  return flow;
}

double PlantLaws::Opening(double opening) const {
  return opening + std::copysign(second_gain * std::max(0.0, std::abs(opening) - knee), opening);
}

double PlantLaws::EdgeFlow(double conductance, double dp) const {
  if (conductance == 0) return 0;
  const bool to_tank = conductance > 0;
  if (to_tank && check_valve > 0) dp = std::max(0.0, dp - check_valve);
  const double root =
      laminar_edge > 0 ? dp / std::sqrt(std::sqrt(dp * dp + laminar_edge * laminar_edge)) : SignedRoot(dp);
  if (!to_tank || return_line == 0) return conductance * root;
  const double drive = root * root;
  const double sum =
      return_line + std::sqrt(return_line * return_line + 4 * drive / (conductance * conductance));
  return std::copysign(2 * drive / sum, dp);
}

double PlantLaws::EdgeDrop(double conductance, double flow) const {
  const double root = std::abs(flow / conductance), square = root * root;
  const double spread = laminar_edge * square;
  const double edge =
      std::sqrt((square * square + std::sqrt(square * square * square * square + 4 * spread * spread)) / 2);
  const double line = conductance > 0 ? return_line * std::abs(flow) + check_valve : 0;
  return std::copysign(edge + line, flow);
}

PlantMoments::PlantMoments(const std::vector<Imperfection>& list, double seconds, std::uint64_t seed)
    : list_(list), seconds_(seconds), seed_(StreamSeed(seed, "intermittent faults")) {}

bool PlantMoments::Chosen(double share, std::int64_t stroke) const {
  constexpr int kGroup = 10;  // strokes among which the share is kept
  const std::int64_t number = std::max<std::int64_t>(0, stroke);
  RandomStream random(StreamSeed(seed_ + static_cast<std::uint64_t>(number / kGroup), "chosen strokes"));
  std::array<int, kGroup> order;
  std::iota(order.begin(), order.end(), 0);
  for (int k = kGroup - 1; k > 0; --k) std::swap(order[k], order[static_cast<int>(random.Uniform(0, k + 1))]);
  return order[static_cast<std::size_t>(number % kGroup)] < std::lround(share * kGroup);
}

PlantMoments::Moment PlantMoments::At(double t, double temperature, std::int64_t stroke) const {
  Moment moment;
  const double part = t / seconds_;
  for (const Imperfection& one : list_) {
    switch (one.kind) {
      case kBulkModulusDrift:
        moment.K_factor += one.size * part;
        break;
      case kBulkModulusTemperature:
        moment.K_factor += one.size * (temperature - kWarmOil);
        break;
      case kVolumeDrift:
        moment.V0_factor += one.size * part;
        break;
      case kFlowGainDrift:
        moment.gain *= 1 + one.size * part;
        break;
      case kBulkModulusStep:
        if (part < one.extras[0]) moment.K_factor += one.size;
        break;
      case kVolumeStep:
        if (part < one.extras[0]) moment.V0_factor += one.size;
        break;
      case kFlowGainStep:
        if (part < one.extras[0]) moment.gain *= 1 + one.size;
        break;
      case kSpoolZeroStep:
        if (part < one.extras[0]) moment.y_0_shift += one.size;
        break;
      case kExponentialViscosity:
        moment.gain *= 1 + one.size * (1 - std::exp(-one.extras[0] * (temperature - one.extras[1])));
        break;
      case kSpoolZeroDrift:
        moment.y_0_shift += one.size * part;
        break;
      case kSpoolZeroTemperature:
        moment.y_0_shift += one.size * (temperature - kWarmOil);
        break;
      case kLeakageTemperature:
        moment.leakage += one.size * std::exp(one.extras[0] * (temperature - one.extras[1]));
        break;
      case kIntermittentLeakage:
        if (Chosen(one.extras[0], stroke)) moment.leakage += one.size;
        break;
      case kLeakyStretch:
        if (part >= one.extras[0] && part < one.extras[0] + one.extras[1]) moment.leakage += one.size;
        break;
      case kIntermittentEffects:
        moment.effects_on = Chosen(one.size, stroke);
        break;
      default:
        break;
    }
  }
  return moment;
}

double PlantMoments::Ripple(double t) const {
  const Imperfection* ripple = FindImperfection(list_, kFlowRipple);
  if (ripple == nullptr) return 0;
  return ripple->size * std::sin(2 * std::numbers::pi * ripple->extras[0] * t + ripple->extras[1]);
}

bool PlantMoments::ripples() const { return FindImperfection(list_, kFlowRipple) != nullptr; }

double PlantMoments::most_leakage() const {
  return SizeOf(list_, kLeakageTemperature) * std::exp(ExtraOf(list_, kLeakageTemperature, 0) * kWarmest) +
         SizeOf(list_, kIntermittentLeakage) + SizeOf(list_, kLeakyStretch);
}

}  // namespace hydroscope
