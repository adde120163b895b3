#pragma once

#include <array>
#include <string_view>

#include "models/effect.h"
#include "models/model_structure.h"

namespace hydroscope {

/// K, oil temperature at which sizes that follow it are stated: 40 degC.
inline constexpr double kStatedAt = 313.15;

inline constexpr double kAirPressure = 1.013e5;  ///< Pa; chamber pressures are gauge pressures

/// Channels of a die-cushion stretch: measured ones, then derived ones.
enum DieCushionChannel {
  kPressureA,       ///< p_A, Pa
  kPosition,        ///< z, m
  kSpool,           ///< y_v, 1
  kPressureB,       ///< p_B, Pa
  kSupplyPressure,  ///< p_0, Pa
  kOilTemperature,  ///< T_oil, K
  kMeasuredChannels,
  kFlowRoot = kMeasuredChannels,  ///< sign(dp) sqrt|dp| over the open edge, sqrt(Pa), corrected for noise
  kSpeed,                         ///< dz/dt smoothed, m/s
  kAcceleration,                  ///< d2z/dt2 smoothed, m/s^2
  kPressureRate,                  ///< dp_A/dt smoothed, Pa/s
  // Logarithms that several effects need; evaluated once.
  kLogPressure,  ///< ln of p_A in Pa, at least 1 Pa
  kLogAbsolute,  ///< ln of p_A above vacuum in atm, at least 1 atm
  kLogOpening,   ///< ln |y_v|, openings below 0.1 % counting as 0.1 %
  kTime,         ///< s, as Stretch::begin counts it
  kDieCushionChannels
};

/// Their names; a measured channel has that of its signal.
inline constexpr std::array<std::string_view, kDieCushionChannels> kCushionChannels = {
    "p_A",     "z",           "y_v",     "p_B",          "p_0",
    "T_oil",   "flow_root",   "speed",   "acceleration", "pressure_rate",
    "ln(p_A)", "ln(p_A abs)", "ln|y_v|", "time"};

/// Fills the logarithms of the channels they are of.
void FillLogarithms(Stretch& stretch);

/// The balance of a die-cushion cylinder with its valve to tank (Krimpmann-type grey box of the press paper, eq. 6-8):
///   A_A dz/dt = theta1 root(dp) y_v + theta2 dp_A/dt + theta3 z dp_A/dt + theta4 root(dp)
/// theta1 = -Q_vn / sqrt(dp_nom), theta2 = -V0/K', theta3 = -A_A/K', theta4 = Q_vn/sqrt(dp_nom) y_0,
/// and back (eq. 13-16) K', V0, Q_vn, y_0. Needs signals p_A, z, y_v and geometry A_A, dp_nom.
Result<std::shared_ptr<ModelStructure>> BuildDieCushion(const Machine& machine);

}  // namespace hydroscope
