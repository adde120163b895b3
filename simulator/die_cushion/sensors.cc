#include "simulator/die_cushion/sensors.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace hydroscope {

double& ChannelOf(PressRow& row, int index) {
  double PressRow::*const members[] = {&PressRow::p_A, &PressRow::p_B, &PressRow::p_0,  &PressRow::z,
                                       &PressRow::y_v, &PressRow::U_v, &PressRow::T_oil};
  return row.*members[index];
}

std::optional<int> ChannelIndex(std::string_view name) {
  const auto found = std::find(kPressChannels.begin(), kPressChannels.end(), name);
  if (found == kPressChannels.end()) return std::nullopt;
  return static_cast<int>(found - kPressChannels.begin());
}

NoiseSource::NoiseSource(const SensorNoise& noise, std::uint64_t seed)
    : std_{noise.p_A, noise.p_B, noise.p_0, noise.z, noise.y_v, noise.U_v, noise.T_oil},
      random_(StreamSeed(seed, "sensor noise")) {}

std::array<double, 7> NoiseSource::Next() {
  std::array<double, 7> draw;
  for (std::size_t k = 0; k < draw.size(); ++k) draw[k] = std_[k] * random_.Normal();
  return draw;
}

void ReadSensors(const SensorNoise& noise, const SensorQuantum& quantum, const std::array<double, 7>& draw,
                 PressRow& row) {
  const double steps[] = {quantum.p_A, quantum.p_B, quantum.p_0,  quantum.z,
                          quantum.y_v, quantum.U_v, quantum.T_oil};
  if (noise.hum_amplitude != 0) {
    const double mains = 2 * std::numbers::pi * 50 * row.t;
    row.p_A += noise.hum_amplitude * (std::sin(mains) + std::sin(2 * mains + 0.7) / 2);
  }
  for (int k = 0; k < 7; ++k) {
    double& value = ChannelOf(row, k);
    value += draw[k];
    if (steps[k] > 0) value = std::round(value / steps[k]) * steps[k];
  }
}

FaultInjector::FaultInjector(const std::vector<SensorFault>& faults) {
  for (const SensorFault& fault : faults) Add(fault);
}

void FaultInjector::Add(const SensorFault& fault) {
  Active active;
  active.fault = fault;
  active.channel = ChannelIndex(fault.channel).value_or(0);
  active.next_spike = fault.start;
  faults_.push_back(active);
}

bool FaultInjector::Apply(PressRow& row) {
  constexpr double kSpikeInterval = 0.1;  // s
  const double t = row.t + 1e-9;          // so that a row at `start` belongs to the fault
  bool present = true;
  double clock = 0;
  for (Active& active : faults_) {
    const SensorFault& fault = active.fault;
    double& value = ChannelOf(row, active.channel);
    const double since = t - fault.start;
    if (since < 0) continue;
    const bool within = since < fault.duration;
    switch (fault.kind) {
      case FaultKind::kNan:
        if (within) value = std::numeric_limits<double>::quiet_NaN();
        break;
      case FaultKind::kStuck:
        if (!active.begun) active.held = value;
        if (within) value = active.held;
        break;
      case FaultKind::kSpike:
        if (t >= active.next_spike && (within || !active.begun)) {
          value += fault.size;
          active.next_spike += kSpikeInterval;
        }
        break;
      case FaultKind::kDropout:
        present = present && !within;
        break;
      case FaultKind::kOffsetDrift:
        value += within ? fault.size * since / fault.duration : fault.size;
        break;
      case FaultKind::kClockJump:
        if (within || fault.duration <= 0) clock += fault.size;
        break;
    }
    active.begun = true;
  }
  row.t += clock;
  return present;
}

}  // namespace hydroscope
