#pragma once

#include "simulator/die_cushion/effects.h"
#include "simulator/die_cushion/motion.h"
#include "simulator/die_cushion/plant_laws.h"
#include "simulator/die_cushion/press_options.h"

namespace hydroscope {

/// Chamber A of the cushion with its valve, integrated with a fine fixed step.
///
///   C(p_A, z) dp_A/dt = -A_A dz/dt - Q_valve - Q_leak,   C = V/K without effects, V = V0 + A_A z
///   edge A -> tank, y > y_0:    Q = Q_vn/sqrt(dp_nom) (y - y_0) sqrt(p_A - p_t)
///   edge supply -> A, y < y_0:  Q = Q_vn/sqrt(dp_nom) (y - y_0) sqrt(p_0 - p_A)
///
/// Fourth-order Runge-Kutta; with line inertance the oil column is a second state, split off symmetrically
/// and solved exactly (a Riccati equation), because a nearly closed valve makes it stiff. Below the vapour
/// pressure the pressure stays and a cavity grows instead, which inflow fills again. Imperfections of the
/// plant (plant_laws.h) change the edges' law, add leakage and move the parameters.
class PressPlant {
 public:
  PressPlant(const PressMachine& machine, const PressEffectSizes& effects, double step,
             const PlantLaws& laws = {});

  /// What the surroundings do over one step. Motion and opening at its begin, middle and end.
  struct Drive {
    RamMotion::Point ram[3];
    double opening[3];                   ///< 1, y_v - y_0 of the metering edge
    double p_B = 0, p_0 = 0;             ///< Pa
    double gain = 1;                     ///< flow gain, relative
    double K_factor = 1, V0_factor = 1;  ///< 1, of the machine's values
    double leakage = 0;                  ///< m^3/(s Pa), times p_A - p_B
    double extra_flow = 0;               ///< m^3/s out of the chamber
  };

  /// Other effects from now on; the step must stay below the inverse of their StiffestRate.
  void SetEffects(const PressEffectSizes& effects);
  void Reset(double p_A) { p_A_ = p_A, line_flow_ = 0, cavity_ = 0; }
  void Step(const Drive& drive);

  double p_A() const { return p_A_; }        ///< Pa, gauge
  double cavity() const { return cavity_; }  ///< m^3
  /// Flow out of chamber A through the valve for the given state, m^3/s.
  double ValveFlow(double conductance, double p_A, double p_0) const;
  /// Signed flow per root of pressure, m^3/(s sqrt(Pa)), of an opening.
  double Conductance(double opening, double gain) const;
  /// Largest rate of the pressure equation, 1/s; the step must stay well below its inverse.
  static double StiffestRate(const PressMachine& machine, const PressEffectSizes& effects, double z_bottom,
                             const PlantLaws& laws = {});

 private:
  void StepPressure(const Drive& drive, const double conductance[3]);
  void StepLine(double conductance, double p_0, double step);
  double Slope(double p_A, double conductance, const RamMotion::Point& ram, const Drive& drive) const;
  double Volume(const RamMotion::Point& ram, const Drive& drive) const;
  double Modulus(double p_A, const Drive& drive) const;
  double LineFlow(double conductance, double drop, double step) const;

  PressMachine machine_;
  PressEffectSizes effects_;
  PlantLaws laws_;
  double step_;
  double nominal_;  // Q_vn / sqrt(dp_nom)
  bool plain_;      // neither leakage nor gas: the fast path
  double p_A_ = 0, line_flow_ = 0, cavity_ = 0;
};

}  // namespace hydroscope
