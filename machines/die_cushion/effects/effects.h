#pragma once

#include "machines/die_cushion/balance.h"
#include "machines/die_cushion/library.h"
#include "models/effect.h"

/// The die cushion's library: one law, one file. To add an effect, write its file and add it here and in
/// machines/die_cushion/library.cc; the conformance suite picks it up by itself.
///
/// Signs: the balance is A_A dz/dt = ... with flow out of chamber A counted negative, so a leak's column is
/// -integral of its flow per unit parameter and its parameter is positive.
namespace hydroscope::effects {

/// Polytropic exponent of a gas that nobody has measured: isothermal 1.0 to adiabatic 1.4, all alike likely.
inline constexpr double kPolytropic = 1.2, kPolytropicStd = 0.115;

Effect InternalLeakage(const CushionGeometry&);
Effect ExternalLeakage(const CushionGeometry&);
Effect OrificeLeakage(const CushionGeometry&);
Effect EntrainedAir(const CushionGeometry&);
Effect Accumulator(const CushionGeometry&);
Effect ReliefValve(const CushionGeometry&);
Effect TankBackPressure(const CushionGeometry&);
Effect ValveFlowCurvature(const CushionGeometry&);
Effect ValveFlowAsymmetry(const CushionGeometry&);
Effect SpoolOverlap(const CushionGeometry&);
Effect SpoolHysteresis(const CushionGeometry&);
Effect OilViscosity(const CushionGeometry&);
Effect PressureOffset(const CushionGeometry&);
Effect SpoolSignalDelay(const CushionGeometry&);
Effect PressureSignalDelay(const CushionGeometry&);
Effect PositionSignalDelay(const CushionGeometry&);
Effect PositionDependentLeakage(const CushionGeometry&);
Effect LineInertance(const CushionGeometry&);
// Tried where samples are at hand (Effect::needs_samples).
Effect ReturnLineResistance(const CushionGeometry&);
Effect TankPressure(const CushionGeometry&);
Effect LaminarEdge(const CushionGeometry&);
Effect PressureDependentBulkModulus(const CushionGeometry&);
Effect LeakageTemperature(const CushionGeometry&);
Effect PressureGain(const CushionGeometry&);
Effect PressureOffsetDrift(const CushionGeometry&);
Effect PressureSignalLag(const CushionGeometry&);
Effect SpoolSignalLag(const CushionGeometry&);
Effect PositionSignalLag(const CushionGeometry&);
Effect SignalLag(const CushionGeometry&);
Effect PeriodicDisturbance(const CushionGeometry&);
Effect BulkModulusDrift(const CushionGeometry&);
Effect DeadVolumeDrift(const CushionGeometry&);
Effect FlowGainDrift(const CushionGeometry&);
Effect SpoolNullDrift(const CushionGeometry&);

}  // namespace hydroscope::effects
