#include "simulator/own_states/sensors.h"

#include <cmath>
#include <random>

namespace hydroscope {

double StateSensor::Floor() const { return std::sqrt(noise * noise + step * step / 12); }

std::vector<double> Sensed(const std::vector<double>& values, const StateSensor& sensor, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  const double slow = sensor.noise * std::sqrt(sensor.coloured),
               fast = sensor.noise * std::sqrt(1 - sensor.coloured),
               fresh = std::sqrt(1 - sensor.memory * sensor.memory);
  double remembered = normal(random);
  std::vector<double> out;
  for (const double value : values) {
    remembered = sensor.memory * remembered + fresh * normal(random);
    double reading = value + slow * remembered + fast * normal(random);
    if (reading >= sensor.end) {
      out.push_back(std::nan(""));
      continue;
    }
    if (sensor.step > 0) reading = sensor.step * std::round(reading / sensor.step);
    out.push_back(sensor.gain * reading + sensor.zero);
  }
  return out;
}

}  // namespace hydroscope
