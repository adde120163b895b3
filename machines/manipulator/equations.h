#pragma once

#include <string>

#include "models/linear_form.h"
#include "models/machine.h"

namespace hydroscope::manipulator {

/// Texts of the manipulator's equations. Joint i is 1 or 2; angles q_i are counted from the link before, that of the first from
/// the horizontal. `angle` and `speed` name what stands for them: states, or signals and their rates.
struct Joint {
  int number = 1;
  std::string angle, speed;
};
/// The joint as a state of the model, and as it is measured.
Joint StateJoint(int number);
Joint MeasuredJoint(int number);

/// Piston position, m, by the law of cosines (eq. 16 with the squares of l_1 and l_2 that it lacks), and lever arm, m (eq. 17).
std::string Position(const Joint& joint);
std::string Lever(const Joint& joint);
std::string PistonSpeed(const Joint& joint);

/// Rigid bodies: joint accelerations from base parameters and the torques of the cylinders.
struct BaseParameters {
  std::string mx_1 = "mx_1", my_1 = "my_1", J_1 = "J_1", mx_2 = "mx_2", my_2 = "my_2", J_2 = "J_2";
};
struct Accelerations {
  std::string first, second;
};
/// `torque_1`, `torque_2`: N m, of the cylinders. Mass matrix of the two links inverted (physics: docs/manipulator.md).
Accelerations AccelerationsOf(const BaseParameters& base, const std::string& torque_1,
                              const std::string& torque_2);
/// What a torque about joint `torque` gives to the acceleration of joint `of`: an element of the inverse mass matrix.
std::string Mobility(int of, int torque);
/// Force of the cylinder of a joint on the link, N: pressures less friction of the piston.
std::string CylinderForce(int joint);
/// Torque of the cylinder of a joint: pressures less friction of the piston.
std::string CylinderTorque(int joint);

/// Rate of the pressure in chamber 1 (piston side) or 2, eq. 10 ... 12, from what flows in besides the piston's own motion.
std::string PressureRate(int joint, int chamber, const std::string& flow_in);
/// The same of all four edges; what flows in by them; K/V.
std::string PressureRate(int joint, int chamber);
std::string Stiffness(int joint, int chamber);
/// An edge "PA", "AT", "PB" or "BT" of a valve: coefficient, its opening, the root of its pressure difference.
std::string EdgeCoefficient(const std::string& edge, int joint);
std::string EdgeOpening(const std::string& edge, int joint);
std::string EdgeRoot(const std::string& edge, int joint);
/// Chamber that an edge leads to, and +1 where it fills it, -1 where it drains it.
int EdgeChamber(const std::string& edge);
int EdgeSign(const std::string& edge);

/// Base parameters, pressures and edges as the file knows them: what [geometry] states is not identified.
StatesSpec States(const Machine& machine);
/// Both joints' torque balances in standard inertial parameters, and the flow balances of all chambers.
LinearForm Linear(const Machine& machine);

}  // namespace hydroscope::manipulator
