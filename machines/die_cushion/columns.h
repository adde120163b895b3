#pragma once

#include <span>

#include "models/wide_stretch.h"

/// Columns of a balance (Column::Fill), each by what it is an integral of: a function of the values that some channels have
/// at one sample.
namespace hydroscope {

/// A channel as it is.
struct AsItIs {
  double operator()(double value) const { return value; }
};

/// A function of channels: what IntegralOver takes.
template <typename Value, int... kChannels>
struct ValueOf {
  Value value;
  auto In(const Stretch& s) const {
    return [value = value, ... x = s[kChannels]](int k) { return value(x[k]...); };
  }
};
template <int... kChannels, typename Value = AsItIs>
ValueOf<Value, kChannels...> Of(Value value = {}) {
  return {value};
}

/// The integral of rate(channels...) over time.
template <int... kChannels, typename Rate = AsItIs>
auto IntegralOverTime(Rate rate = {}) {
  return [rate = Of<kChannels...>(rate)](const Stretch& s, double&, std::span<double> out) {
    wide::IntegrateOverTime(s, rate.In(s), out);
  };
}

/// What level(channels...) changes by.
template <int... kChannels, typename Level = AsItIs>
auto ChangeOf(Level level = {}) {
  return [level = Of<kChannels...>(level)](const Stretch& s, double&, std::span<double> out) {
    wide::Differences(s, level.In(s), out);
  };
}

/// The integral of a weight over the changes of a level.
template <typename Weight, typename Level>
auto IntegralOver(Weight weight, Level level) {
  return [weight, level](const Stretch& s, double&, std::span<double> out) {
    wide::IntegrateOver(s, weight.In(s), level.In(s), out);
  };
}

}  // namespace hydroscope
