#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include "simulator/die_cushion/press_options.h"
#include "simulator/random.h"

namespace hydroscope {

/// One row of a press log, SI.
struct PressRow {
  double t = 0;      ///< s
  double p_A = 0;    ///< Pa
  double p_B = 0;    ///< Pa
  double p_0 = 0;    ///< Pa
  double z = 0;      ///< m
  double y_v = 0;    ///< 1
  double U_v = 0;    ///< V
  double T_oil = 0;  ///< K
};

inline constexpr std::array<std::string_view, 7> kPressChannels = {"p_A", "p_B", "p_0",  "z",
                                                                   "y_v", "U_v", "T_oil"};
/// The value of channel `index` of kPressChannels.
double& ChannelOf(PressRow& row, int index);
/// Index in kPressChannels, nullopt if there is none of that name.
std::optional<int> ChannelIndex(std::string_view name);

/// White normal noise of row after row. The numbers depend on seed and row alone.
class NoiseSource {
 public:
  NoiseSource(const SensorNoise& noise, std::uint64_t seed);
  /// Noise of the next row in the order of kPressChannels.
  std::array<double, 7> Next();

 private:
  std::array<double, 7> std_;
  RandomStream random_;
};

/// What the sensors make of a true row: noise, hum, then steps of the converter.
void ReadSensors(const SensorNoise& noise, const SensorQuantum& quantum, const std::array<double, 7>& draw,
                 PressRow& row);

/// The faults asked for, row after row.
class FaultInjector {
 public:
  explicit FaultInjector(const std::vector<SensorFault>& faults);
  /// A further fault; `start` on the time of the rows.
  void Add(const SensorFault& fault);
  /// Applies the faults to `row`; false if the row is missing from the log.
  bool Apply(PressRow& row);

 private:
  struct Active {
    SensorFault fault;
    int channel = 0;
    double held = 0, next_spike = 0;
    bool begun = false;
  };
  std::vector<Active> faults_;
};

}  // namespace hydroscope
