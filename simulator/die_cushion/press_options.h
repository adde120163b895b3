#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "core/result.h"

namespace hydroscope {

/// The true parameters of one simulated die-cushion cylinder. Pressures are gauge.
struct PressMachine {
  double K = 1.21e9;            ///< Pa, bulk modulus of the oil
  double V0 = 1.65e-3;          ///< m^3, oil volume of chamber A and pipe at z = 0
  double A_A = 0.0125;          ///< m^2, piston area
  double A_B = 0.0085;          ///< m^2, annulus area on the rod side
  double Q_vn = 1.7e-3;         ///< m^3/s, valve flow at dp_nom and full opening (102 l/min)
  double dp_nom = 35e5;         ///< Pa
  double y_0 = 0.008;           ///< 1, spool position at which no oil flows
  double p_supply = 210e5;      ///< Pa
  double p_tank = 0;            ///< Pa
  double p_rod = 60e5;          ///< Pa, rod side, held by the supply
  double valve_f0 = 184;        ///< Hz
  double valve_damping = 0.67;  ///< 1
  double valve_gain = 1.005;    ///< 1, spool position per (command / 10 V)
  double valve_dead_time = 0;   ///< s
};

/// How the ram and the pressure set point move.
struct PressMotion {
  double speed_min = 0.020,
         speed_max = 0.120;                ///< m/s, ram speed of a stroke is drawn between; equal = constant
  double return_speed = 0.120;             ///< m/s
  double z_top = 0.200, z_bottom = 0.011;  ///< m
  double z_bottom_spread = 0.004;          ///< m, half range of the bottom position between strokes
  double ramp_time = 0.10;                 ///< s, to accelerate and to brake
  double dwell_min = 0.20, dwell_max = 0.40;           ///< s, rest at the bottom and at the top
  double set_point_min = 40e5, set_point_max = 210e5;  ///< Pa, random steps while drawing
  double step_time_min = 0.3, step_time_max = 0.9;     ///< s between steps
  std::vector<double> speeds;  ///< m/s, one stroke after the other, over and over, in place of random ones
  std::vector<double> set_points;  ///< Pa, equal parts of each stroke's time, in place of random steps
  /// Pa, of the rod side, in place of p_rod: the next one after each round of `speeds`.
  std::vector<double> rod_pressures;
  double rest_pressure = 25e5;  ///< Pa, while resting and returning
  double wander = 6e5;          ///< Pa, amplitude of the slow variation of the set point
  double dither = 0.010;        ///< 1, random switching added to the spool command
};

/// Standard deviation of the sensor noise (white, normal).
struct SensorNoise {
  double p_A = 2.2e5;        ///< Pa
  double p_B = 1.1e5;        ///< Pa
  double p_0 = 1.1e5;        ///< Pa
  double z = 1.2e-4;         ///< m
  double y_v = 6.8e-5;       ///< 1
  double U_v = 0;            ///< V
  double T_oil = 0.05;       ///< K
  double hum_amplitude = 0;  ///< Pa, mains hum on p_A: 50 Hz, and half of it at 100 Hz
};

/// Size of one step of the analogue-to-digital converter; 0 = not quantised.
struct SensorQuantum {
  double p_A = 0, p_B = 0, p_0 = 0;  ///< Pa
  double z = 0;                      ///< m
  double y_v = 0;                    ///< 1
  double U_v = 0;                    ///< V
  double T_oil = 0;                  ///< K
};

/// A hidden physical effect: id of simulator/die_cushion/effects.h, its size in SI and further numbers by name.
struct EffectSetting {
  std::string id;
  double size = 0;
  std::map<std::string, double> extra;
};

/// What a plant has and a clean simulation lacks: kind of simulator/die_cushion/imperfections.h, its size in SI, further
/// numbers by name and, where it acts on one, the channel ("" = as the kind says, "all" = all).
struct ImperfectionSetting {
  std::string kind;
  double size = 0;
  std::map<std::string, double> extra;
  std::string channel;
};

enum class FaultKind {
  kNan,          ///< reading is not a number
  kStuck,        ///< reading stays at its value at `start`
  kSpike,        ///< single readings are off by `size`: one at `start`, then one every 0.1 s for `duration`
  kDropout,      ///< rows are missing altogether; `channel` is not looked at
  kOffsetDrift,  ///< zero wanders to `size` over `duration` and stays there
  kClockJump,    ///< time stamps from `start` on are off by `size`; for `duration` only, if that is above 0
};

/// A fault of one channel (p_A, p_B, p_0, z, y_v, U_v, T_oil).
struct SensorFault {
  FaultKind kind = FaultKind::kNan;
  std::string channel = "p_A";
  double start = 0;     ///< s
  double duration = 0;  ///< s
  double size = 0;      ///< SI of the channel; s for a clock jump
};

/// Everything that determines a simulated log. Equal options give equal bytes.
struct PressOptions {
  double seconds = 120;
  double sample_period = 0.002;    ///< s
  double control_period = 0.001;   ///< s, at most; the controller runs a whole number of times per sample
  double max_step = 50e-6;         ///< s, integration step, at most
  std::uint64_t seed = 1;          ///< ram motion, and everything whose own seed is 0
  std::uint64_t control_seed = 0;  ///< pressure set points and the controller's dither; 0 = from `seed`
  std::uint64_t noise_seed = 0;    ///< sensor noise; 0 = from `seed`
  double oil_start = 313.15;       ///< K, oil temperature at the beginning ...
  double oil_end = 313.15;         ///< K, ... and at the end of the log
  PressMachine machine;
  PressMotion motion;
  SensorNoise noise;
  SensorQuantum quantum;
  std::vector<EffectSetting> effects;
  std::vector<ImperfectionSetting> imperfections;  ///< those of readings act in this order
  std::vector<SensorFault> faults;
};

/// Checks ranges, effect ids, imperfections, their extras and channels; the message names value, limit and remedy.
Status Validate(const PressOptions& options);

}  // namespace hydroscope
