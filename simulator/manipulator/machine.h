#pragma once

#include <array>

namespace hydroscope {

inline constexpr int kJoints = 2;

/// A link of the manipulator: a rigid body that turns in the vertical plane about the joint at its beginning.
struct LinkTruth {
  double mass;            ///< kg
  double c_x, c_y;        ///< m, centre of mass along the link and across it
  double inertia_centre;  ///< kg m2, about the centre of mass
  double length;          ///< m, to the next joint; of the last link to the tip
};

/// A differential cylinder that drives a joint, with its four-edge valve.
struct CylinderTruth {
  double l_1, l_2;  ///< m, from the joint to the cylinder's pins on the link before and on the link driven
  double q_0;       ///< rad, angle between those two when the joint angle is 0
  double x_0;       ///< m, length of the retracted cylinder between its pins
  double stroke;    ///< m
  double A_1, A_2;  ///< m2, piston and rod side
  double V_0;       ///< m3, of the line to each chamber
  double K;         ///< Pa, bulk modulus
  double C_PA, C_AT, C_PB, C_BT;  ///< m3/(s sqrt(Pa)), of the edges at full opening
  double b;                       ///< N s/m, viscous friction of the piston
  double F_c;                     ///< N, Coulomb friction of the piston
  std::array<double, 4> worn{};   ///< 1, radius of each edge over full opening, PA, AT, PB, BT; 0: sharp
  double F_stribeck = 0;          ///< N, friction of adhesion beyond F_c ...
  double v_stribeck = 0.01;       ///< m/s, ... that is gone at some such speeds
  double play = 0;                ///< m, between piston rod and link
};

/// A manipulator whose truth is known. The rigid bodies have the base parameters that the paper identified, valves and oil
/// its table II (Hydraulic manipulators, tables I and II); lever geometry and cylinders, which it does not print, are ours.
struct ManipulatorTruth {
  std::array<LinkTruth, kJoints> links;
  std::array<CylinderTruth, kJoints> cylinders;
  double payload = 0;        ///< kg, at the tip, beside what table I holds
  double p_supply = 19e6;    ///< Pa, without flow
  double supply_drop = 4e8;  ///< Pa s/m3, loss of supply pressure per flow
  double supply_lag = 0.05;  ///< s, in which it follows
  double p_t = 0.3e6;        ///< Pa, tank
  double spool_rate = 440;   ///< rad/s, natural frequency of the spools, ...
  double spool_damping = 0.8;
};

/// The machine of the documents.
ManipulatorTruth PublishedManipulator();

/// The same with every parameter that is identified drawn within some 20 % of it.
ManipulatorTruth DrawnManipulator(unsigned long seed);

/// Piston position, m, and lever arm dx/dq, m, at a joint angle by the law of cosines.
struct CylinderReach {
  double x, lever;
};
CylinderReach ReachOf(const CylinderTruth& cylinder, double q);

/// The tip of the arm in the base frame, m; x to the front, y up.
struct TipPosition {
  double x, y;
};
TipPosition TipOf(const ManipulatorTruth& truth, double q_1, double q_2);

/// Joint angles at which the tip is there, elbow up; NaN if it cannot be reached.
std::array<double, kJoints> AnglesOf(const ManipulatorTruth& truth, const TipPosition& tip);

}  // namespace hydroscope
