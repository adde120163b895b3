#include "simulator/die_cushion/sensor_imperfections.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace hydroscope {
namespace {

using enum ImperfectionKind;

constexpr double kColourTime = 0.002;  // s, after which coloured noise is correlated by phi
constexpr int kChannels = static_cast<int>(kPressChannels.size());

/// What a reading of full scale is, in its unit.
double FullScale(int channel) {
  return kPressChannels[static_cast<std::size_t>(channel)] == "U_v" ? 10.0 : 1.0;
}

bool ActsOn(const Imperfection& one, int channel) { return !one.channel || *one.channel == channel; }

}  // namespace

FirstOrderLag::FirstOrderLag(double time, double step) : keep_(time > 0 ? std::exp(-step / time) : 0) {}

double FirstOrderLag::Step(double input) {
  value_ = begun_ ? input + keep_ * (value_ - input) : input;
  begun_ = true;
  return value_;
}

SensorImperfections::SensorImperfections(const std::vector<Imperfection>& list, const PressOptions& o)
    : std_{o.noise.p_A, o.noise.p_B, o.noise.p_0, o.noise.z, o.noise.y_v, o.noise.U_v, o.noise.T_oil},
      period_(o.sample_period),
      seconds_(o.seconds) {
  for (const Imperfection& one : list) {
    const std::string purpose = fmt::format("imperfection {}", active_.size());
    active_.push_back({one, RandomStream(StreamSeed(o.noise_seed, purpose))});
  }
}

template <typename Change>
void SensorImperfections::ForChannels(Active& active, PressRow& row, const Change& change) {
  for (int k = 0; k < kChannels; ++k)
    if (ActsOn(active.one, k)) change(k, ChannelOf(row, k));
}

void SensorImperfections::Distort(PressRow& row) {
  const double part = row.t / seconds_;
  for (Active& active : active_) {
    const Imperfection& one = active.one;
    switch (one.kind) {
      case kPressureGain:
        row.p_A *= 1 + one.size;
        break;
      case kPressureGainTemperature:
        row.p_A *= 1 + one.size * (row.T_oil - kWarmOil);
        break;
      case kPressureGainDrift:
        row.p_A *= 1 + one.size * part;
        break;
      case kPressureZero:
        row.p_A += one.size;
        break;
      case kPressureZeroDrift:
        row.p_A += one.size * part;
        break;
      case kPressureZeroTemperature:
        row.p_A += one.size * (row.T_oil - one.extras[0]);
        break;
      case kPressureCrosstalk:
        ForChannels(active, row, [&, read = row.p_A](int k, double& value) {
          row.p_A = read + one.size * value / FullScale(k);
        });
        break;
      case kDisplacementGainTemperature:
        ForChannels(active, row, [&](int, double& value) { value *= 1 + one.size * (row.T_oil - kWarmOil); });
        break;
      case kSpoolBend:
        row.y_v += one.size * row.y_v * std::pow(std::abs(row.y_v), one.extras[0] - 1);
        break;
      case kPressureBend:
        row.p_A *= 1 + one.size * row.p_A / 100e5;
        break;
      case kPositionBend:
        row.z += one.size * row.z * (1 - row.z / one.extras[0]);
        break;
      case kSpoolPressure:
        row.y_v += one.size * row.p_A;
        break;
      case kFlowGainPressure:
        row.y_v /= 1 + one.size * (row.p_A / 100e5 - 1);
        break;
      case kSensorHum:
        row.p_A += one.size * std::sin(2 * std::numbers::pi * one.extras[0] * row.t + one.extras[1]);
        break;
      case kBadStretch:
        if (part >= one.extras[0] && part < one.extras[0] + one.extras[1]) row.p_A += one.size;
        break;
      case kFrozen:
        Hold(active, row);
        break;
      default:
        break;
    }
  }
}

std::array<double, 7> SensorImperfections::Noise(const std::array<double, 7>& white) {
  std::array<double, 7> noise = white;
  for (Active& active : active_) {
    const Imperfection& one = active.one;
    for (int k = 0; k < kChannels; ++k) {
      if (!ActsOn(one, k)) continue;
      if (one.kind == kColouredNoise) {
        const double phi = std::pow(one.extras[0], period_ / kColourTime);
        double& state = active.held[k];
        const double innovation = std_[k] * active.random.Normal();
        // The first value is drawn from the process at rest, so that the noise is stationary from the first
        // row on.
        state = active.begun[k] ? phi * state + std::sqrt(1 - phi * phi) * innovation : innovation;
        active.begun[k] = true;
        noise[k] = std::sqrt(one.extras[1]) * noise[k] + std::sqrt(one.size) * state;
      } else if (one.kind == kHeavyTails && active.random.Uniform() < one.size) {
        noise[k] *= one.extras[0];
      }
    }
  }
  return noise;
}

void SensorImperfections::Filter(Active& active, PressRow& row) {
  const double keep = active.one.size > 0 ? std::exp(-period_ / active.one.size) : 0;
  ForChannels(active, row, [&](int k, double& value) {
    double& state = active.held[k];
    state = active.begun[k] ? value + keep * (state - value) : value;
    active.begun[k] = true;
    value = state;
  });
}

void SensorImperfections::Hold(Active& active, PressRow& row) {
  constexpr double kRounding = 1e-9;  // s, so that a row at `begin` is held
  const double since = row.t + kRounding - active.one.extras[0];
  if (since < 0 || since >= active.one.size) return;
  ForChannels(active, row, [&](int k, double& value) {
    if (!active.begun[k]) active.held[k] = value;
    active.begun[k] = true;
    value = active.held[k];
  });
}

void SensorImperfections::Spike(Active& active, PressRow& row) {
  ForChannels(active, row, [&](int k, double& value) {
    const bool now = active.random.Uniform() < active.one.extras[0] * period_;
    const double sign = active.random.Uniform() < 0.5 ? -1 : 1;
    if (now) {
      active.held[k] = sign * active.one.size * std_[k];
      active.rows_left[k] = std::lround(active.one.extras[1]);
    }
    if (active.rows_left[k] > 0) {
      value += active.held[k];
      --active.rows_left[k];
    }
  });
}

template <typename IsNew>
void SensorImperfections::Repeat(Active& active, PressRow& row, const IsNew& is_new) {
  ForChannels(active, row, [&](int k, double& value) {
    double& held = active.held[k];
    if (!active.begun[k] || is_new(k, value, held)) held = value;
    active.begun[k] = true;
    value = held;
  });
}

bool SensorImperfections::Transport(PressRow& row) {
  bool present = true;
  for (Active& active : active_) {
    const Imperfection& one = active.one;
    switch (one.kind) {
      case kPlcFilter:
        Filter(active, row);
        break;
      case kSpikes:
        Spike(active, row);
        break;
      case kSaturation:
        ForChannels(active, row, [&](int, double& value) { value = std::clamp(value, -one.size, one.size); });
        break;
      case kQuantisation:
        ForChannels(active, row, [&](int k, double& value) {
          const double step = one.size * std_[k];
          if (step > 0) value = std::round(value / step) * step;
        });
        break;
      case kSlowTask:
        Repeat(active, row, [&](int, double, double) {
          return std::llround(row.t / period_) % std::llround(one.size) == 0;
        });
        break;
      case kDeadband:
        Repeat(active, row, [&](int k, double value, double held) {
          return std::abs(value - held) >= one.size * std_[k];
        });
        break;
      case kStuck:
        Hold(active, row);
        break;
      case kWrongUnit:
        ForChannels(active, row, [&](int, double& value) { value *= one.size; });
        break;
      case kTimeJitter:
        row.t += one.size * period_ * active.random.Uniform(-1, 1);
        break;
      case kDroppedRows:
        present = active.random.Uniform() >= one.size && present;
        break;
      default:
        break;
    }
  }
  return present;
}

}  // namespace hydroscope
