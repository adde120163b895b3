#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/result.h"

namespace hydroscope {

/// Wear: relative changes per second of the figures of a transfer function, in a straight line from some time of the log on.
struct TestCylinderDrift {
  double f_h = 0, zeta_h = 0, f_sv = 0, K_sv = 0;  ///< 1/s
  double from = 0;                                 ///< s
};

/// A servo-hydraulic test cylinder in closed position control, excited by noise on its set point (Li and Thurner 2013).
/// Stated by the figures of its transfer function; its physical constants follow from them.
struct TestCylinderOptions {
  double f_h = 343;           ///< Hz, natural frequency of mass and oil column
  double zeta_h = 0.9766;     ///< its damping
  double f_sv = 160;          ///< Hz, corner of the valve
  double K_sv = 0.0114;       ///< m3/(s A), flow gain of the valve
  double area = 1300.6e-6;    ///< m2
  double volume = 167523e-9;  ///< m3, both chambers
  double mass = 6.07;         ///< kg
  double supply = 210e5;      ///< Pa
  double leak_share = 0;      ///< of the damping that leakage causes; the rest is friction

  double seconds = 60;
  double sample_period = 2e-4;  ///< s; the controller's too, which holds the current between
  double excitation = 8.9e-3;   ///< A, standard deviation of the current that the set point causes
  double low_share = 0.3;       ///< of that: by noise below 10 Hz, the rest by noise from 150 to 450 Hz
  double noise = 2e-6;          ///< m, standard deviation of the position's reading
  double disturbance = 0.5e-3;  ///< A, standard deviation of what disturbs the valve, below 10 Hz
  double crossover = 8;         ///< Hz, of the position loop
  double integral_time = 0.5;   ///< s
  double derivative_time = 0;   ///< s
  std::uint64_t seed = 1;

  double coulomb = 0;              ///< N
  double sensor_delay = 0;         ///< s
  double saturation = 0;           ///< A, current above which the valve does not follow; 0 = none
  double trapped_air = 0;          ///< share of the chambers' volume at mean pressure
  double specimen = 0;             ///< N/m
  double leakage = 0;              ///< m3/(s Pa), across the piston, beside that of leak_share
  bool square_root_valve = false;  ///< flow falls with the root of the pressure left over the edges
  TestCylinderDrift drift = {};
};

/// The larger valve of the paper's table 1, in place of the figures above.
inline constexpr double kZetaWith38 = 1.0012, kGainOf38 = 0.0230;

/// The message names value and limits.
Status Validate(const TestCylinderOptions& options);

struct TestCylinderLog {
  std::vector<double> t;      ///< s
  std::vector<double> z_set;  ///< m
  std::vector<double> I_v;    ///< A
  std::vector<double> z;      ///< m
};

/// `options` must pass Validate().
TestCylinderLog SimulateTestCylinder(const TestCylinderOptions& options);

/// What a transfer function of current to position has for true values, small movements taken (effects that make it another
/// one, saturation and Coulomb friction, left out).
struct TestCylinderTruth {
  double f_h, zeta_h, f_sv, K_sv, T_d;
};
TestCylinderTruth TruthOf(const TestCylinderOptions& options);

/// Header and lines t,z_set,I_v,z in s, mm, mA, mm.
std::string FormatTestCylinder(const TestCylinderLog& log);

}  // namespace hydroscope
