#pragma once

#include <array>

#include "simulator/manipulator/machine.h"
#include "simulator/manipulator/motion.h"

namespace hydroscope {

/// What the controller believes of the machine; geometry, areas, pressures of tank and supply are known to it.
struct ControllerModel {
  /// m c_x1 + m_2 a_1, m c_y1, I_1 + m_2 a_1^2, m c_x2, m c_y2, I_2; kg m and kg m2.
  std::array<double, 6> rigid{};
  std::array<double, kJoints> b{}, F_c{};              ///< N s/m, N
  std::array<double, kJoints> K{};                     ///< Pa
  std::array<std::array<double, 4>, kJoints> edges{};  ///< C_PA, C_AT, C_PB, C_BT, m3/(s sqrt(Pa))
};

/// The true values; what the paper's CAD and datasheet say (table I; 100 l/min at 70 bar taken as one edge, as printed;
/// friction as identified, as in its table IV; of oil 1.4 GPa, which it does not print).
ControllerModel TrueModel(const ManipulatorTruth& truth);
ControllerModel DatasheetModel(const ManipulatorTruth& truth);

/// Feedback, as rates; the gains of the paper's table III follow from them and the controller's model (GainsOf). With the gains
/// as printed and our geometry the arm does not come to rest: the smoothing is 50 ms there.
struct ControllerRates {
  double position = 10;    ///< 1/s
  double speed = 4;        ///< 1/s, of a body against its inertia
  double force = 70;       ///< 1/s, of a cylinder's force
  double piston = 2e-2;    ///< m, flow per piston speed that is missing
  double smoothing = 0.4;  ///< of y(n) = (1 - a) y(n-1) + a z(n), per sample of 2 ms
};

/// k_p, 1/s; k_v, N m s, per body; k_f, m2/(s N), per cylinder; k_x, m: from what the controller believes of the machine.
struct ControllerGains {
  double k_p = 0, k_x = 0;
  std::array<double, kJoints> k_v{}, k_f{};
};
ControllerGains GainsOf(const ControllerModel& model, const ControllerRates& rates);

/// What the controller reads.
struct ManipulatorReadings {
  std::array<double, kJoints> q{}, p_1{}, p_2{}, spool{};
  double p_s = 0;
};

/// The paper's controller (eq. 19 ... 24): required joint speeds from the tip's error, torques from the rigid bodies, piston
/// forces, flows, valve commands.
class ManipulatorController {
 public:
  static constexpr double kPeriod = 2e-3;  ///< s

  ManipulatorController(const ManipulatorTruth& geometry, const ControllerModel& model,
                        const ControllerRates& rates)
      : geometry_(geometry), model_(model), gains_(GainsOf(model, rates)), smoothing_(rates.smoothing) {}

  /// Valve commands, -1 ... 1.
  std::array<double, kJoints> Command(const ManipulatorReadings& readings, const TipReference& reference);

 private:
  /// A rate from differences, smoothed.
  struct Smoothed {
    double last = 0, rate = 0;
    bool begun = false;
    double Take(double value, double smoothing);
  };

  ManipulatorTruth geometry_;
  ControllerModel model_;
  ControllerGains gains_;
  double smoothing_;
  std::array<Smoothed, kJoints> speed_, required_, force_;
  std::array<double, kJoints> measured_force_{};
  bool begun_ = false;
};

}  // namespace hydroscope
