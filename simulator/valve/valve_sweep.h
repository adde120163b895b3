#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/result.h"

namespace hydroscope {

/// A servo valve driven by sines of one frequency after the other, drives off.
struct ValveSweepOptions {
  std::vector<double> frequencies = {10, 20,  30,  40,  50,  60,  70,  80,
                                     90, 100, 110, 120, 130, 140, 150, 160};  ///< Hz
  double amplitude = 0.05;    ///< 1, of full scale: 0.5 V of 10 V
  double hold = 1.0;          ///< s at each frequency, at least; rounded up to whole periods
  double sample_rate = 1000;  ///< Hz
  double update_rate = 0;     ///< Hz at which the command is refreshed and held; 0 = continuous
  double f0 = 183.9;          ///< Hz
  double damping = 0.6735;    ///< 1
  double gain = 1.005;        ///< 1, spool position per (command / 10 V)
  double dead_time = 0;       ///< s
  double zero = 0;            ///< 1, spool position at no command
  double noise = 6.8e-5;      ///< 1, standard deviation of the spool reading
  double command_noise = 0;   ///< V, standard deviation of the command reading
  std::uint64_t seed = 1;
};

/// The message names value and limit.
Status Validate(const ValveSweepOptions& options);

struct ValveSweepLog {
  std::vector<double> t;    ///< s
  std::vector<double> U_v;  ///< V
  std::vector<double> y_v;  ///< 1
};

/// `options` must pass Validate(). Spool: y''/w0^2 + 2 D y'/w0 + y = K_v U(t - T_dead)/10 V, integrated
/// exactly over steps of about 10 us with the command at the middle of the step.
ValveSweepLog SimulateValveSweep(const ValveSweepOptions& options);

/// Header and lines t,U_v,y_v in s, V, 1.
std::string FormatValveSweep(const ValveSweepLog& log);

}  // namespace hydroscope
