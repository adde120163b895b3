#include "machines/die_cushion/generic_laws.h"

#include <cmath>
#include <limits>
#include <string_view>

#include "machines/die_cushion/balance.h"

namespace hydroscope {
namespace {

constexpr const char* kPrefix = "generic: ";
// With these begin the laws of the flow through the valve.
constexpr std::string_view kGain = "flow gain", kNull = "null";
// Much the same as an effect of the library, and yet of another cause: a leak to a side of another pressure.
constexpr std::string_view kLeak = "flow with ";
// Scales that bring every signal to about 1, so that the laws are of similar size.
constexpr double kPressure = 1e7, kPosition1 = 0.1, kSpeed1 = 0.1, kTemperature = 10.0;

double P(const Stretch& s, int k) { return s[kPressureA][k] / kPressure; }
double B(const Stretch& s, int k) { return s[kPressureB][k] / kPressure; }
double Z(const Stretch& s, int k) { return s[kPosition][k] / kPosition1; }
double Y(const Stretch& s, int k) { return s[kSpool][k]; }
double Valve(const Stretch& s, int k) { return s[kFlowRoot][k] * s[kSpool][k]; }
double Oil(const Stretch& s, int k) { return (s[kOilTemperature][k] - kStatedAt) / kTemperature; }
double LogOf(const Stretch& s, int k) {
  return std::log(std::max(s[kPressureA][k] + kAirPressure, kAirPressure));
}
double Inverse(const Stretch& s, int k) {
  return kPressure / std::max(s[kPressureA][k] + kAirPressure, kAirPressure);
}

/// A flow of that rate.
template <typename Rate>
Column::Fill FlowOf(Rate rate) {
  return [rate](const Stretch& s, double&, std::span<double> out) {
    IntegrateOverTime(
        s, [&](int k) { return rate(s, k); }, out);
  };
}

/// A volume of that size.
template <typename Volume>
Column::Fill Stored(Volume volume) {
  return [volume](const Stretch& s, double&, std::span<double> out) {
    Differences(
        s, [&](int k) { return volume(s, k); }, out);
  };
}

/// A volume of that size for every position.
template <typename Volume>
Column::Fill Stroke(Volume volume) {
  return [volume](const Stretch& s, double&, std::span<double> out) {
    IntegrateOver(
        s, [&](int k) { return Z(s, k); }, [&](int k) { return volume(s, k); }, out);
  };
}

/// A law of the columns of `variant`.
std::shared_ptr<const Effect> Law(const char* what, EffectVariant variant, std::vector<int> channels = {}) {
  auto effect = std::make_shared<Effect>();
  effect->id = std::string(kPrefix) + what;
  effect->title = what;
  effect->generic = true;
  effect->plain_flow = effect->title.starts_with(kLeak);
  effect->walks = effect->title.starts_with(kGain) || effect->title.starts_with(kNull);
  effect->min = -std::numeric_limits<double>::infinity();
  effect->max = std::numeric_limits<double>::infinity();
  effect->typical = std::numeric_limits<double>::infinity();
  effect->channels = std::move(channels);
  effect->variant = [variant = std::move(variant)](const auto&) { return variant; };
  return effect;
}

std::shared_ptr<const Effect> Law(const char* what, Column::Fill fill, std::vector<int> channels = {}) {
  return Law(what, PlainVariant(std::move(fill)), std::move(channels));
}

/// A volume of that size for every volume of the oil column, V_0 + A z.
template <typename Volume>
EffectVariant OilVolume(Volume volume) {
  return {{Stored(volume), Stroke(volume)}, [](const ShapeContext& c) {
            const double dead_length = c.theta[1] / c.theta[2];
            return std::vector<double>{dead_length / kPosition1, 1.0};
          }};
}

}  // namespace

std::vector<std::shared_ptr<const Effect>> CushionLaws() {
  return {
      Law("constant flow", FlowOf([](const Stretch&, int) { return 1.0; })),
      Law("flow with p_A", FlowOf([](const Stretch& s, int k) { return P(s, k); })),
      Law("flow with p_A^2", FlowOf([](const Stretch& s, int k) { return P(s, k) * P(s, k); })),
      Law("flow with p_A z", FlowOf([](const Stretch& s, int k) { return P(s, k) * Z(s, k); })),
      Law("flow with p_A z^2", FlowOf([](const Stretch& s, int k) { return P(s, k) * Z(s, k) * Z(s, k); })),
      Law("flow with p_A - p_B", FlowOf([](const Stretch& s, int k) { return P(s, k) - B(s, k); }),
          {kPressureB}),
      Law("flow with y_v", FlowOf([](const Stretch& s, int k) { return Y(s, k); })),
      Law("flow gain with y_v",
          FlowOf([](const Stretch& s, int k) { return Valve(s, k) * std::abs(Y(s, k)); })),
      Law("flow gain with y_v^2",
          FlowOf([](const Stretch& s, int k) { return Valve(s, k) * Y(s, k) * Y(s, k); })),
      Law("flow gain with p_A", FlowOf([](const Stretch& s, int k) { return Valve(s, k) * P(s, k); })),
      Law("flow gain with z", FlowOf([](const Stretch& s, int k) { return Valve(s, k) * Z(s, k); })),
      Law("flow gain with T_oil", FlowOf([](const Stretch& s, int k) { return Valve(s, k) * Oil(s, k); }),
          {kOilTemperature}),
      Law("null with T_oil", FlowOf([](const Stretch& s, int k) { return s[kFlowRoot][k] * Oil(s, k); }),
          {kOilTemperature}),
      Law("volume with p_A^2", Stored([](const Stretch& s, int k) { return P(s, k) * P(s, k); })),
      Law("volume with log p_A", Stored(LogOf)),
      Law("volume with 1/p_A", Stored(Inverse)),
      Law("stroke volume with log p_A", Stroke(LogOf)),
      Law("oil volume with log p_A", OilVolume(LogOf)),
      Law("oil volume with 1/p_A", OilVolume(Inverse)),
      Law("volume with dz/dt", Stored([](const Stretch& s, int k) { return s[kSpeed][k] / kSpeed1; })),
      Law("volume with y_v", Stored([](const Stretch& s, int k) { return Valve(s, k); })),
      Law("volume with dp_A/dt",
          Stored([](const Stretch& s, int k) { return s[kPressureRate][k] / kPressure; })),
  };
}

}  // namespace hydroscope
