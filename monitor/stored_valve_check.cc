#include "monitor/stored_valve_check.h"

namespace hydroscope {

ValveCheck StoredValveCheck(const ValveCheckRecord& record) {
  ValveCheck check;
  check.time = record.begin;
  check.natural_frequency = {record.f0, record.f0_std};
  check.damping = {record.damping, record.damping_std};
  check.gain = {record.gain, record.gain_std};
  check.dead_time = {record.dead_time, record.dead_time_std};
  check.bandwidth = {record.bandwidth, record.bandwidth_std};
  check.amplitude = record.amplitude;
  check.supply_pressure = record.supply_pressure;
  check.oil_temperature = record.oil_temperature;
  return check;
}

}  // namespace hydroscope
