#pragma once

#include "machines/die_cushion/balance.h"
#include "machines/die_cushion/library.h"
#include "models/effect.h"

/// The die cushion's library: one law, one file. To add an effect, write its file and a line here; the conformance suite
/// picks it up by itself.
///
/// Signs: the balance is A_A dz/dt = ... with flow out of chamber A counted negative, so a leak's column is
/// -integral of its flow per unit parameter and its parameter is positive.

/// Effects whose columns every stored Gram carries, in their order: databases know columns by name, so one may be added.
#define HYDROSCOPE_STORED_EFFECTS(_) \
  _(InternalLeakage)                 \
  _(ExternalLeakage)                 \
  _(OrificeLeakage)                  \
  _(EntrainedAir)                    \
  _(Accumulator)                     \
  _(ReliefValve)                     \
  _(TankBackPressure)                \
  _(ValveFlowCurvature)              \
  _(ValveFlowAsymmetry)              \
  _(SpoolOverlap)                    \
  _(SpoolHysteresis)                 \
  _(OilViscosity)                    \
  _(PressureOffset)                  \
  _(SpoolSignalDelay)                \
  _(PressureSignalDelay)             \
  _(PositionSignalDelay)             \
  _(PositionDependentLeakage)        \
  _(LineInertance)

/// Effects that are tried where samples are at hand (Effect::needs_samples).
#define HYDROSCOPE_SAMPLE_EFFECTS(_) \
  _(ReturnLineResistance)            \
  _(TankPressure)                    \
  _(LaminarEdge)                     \
  _(PressureDependentBulkModulus)    \
  _(LeakageTemperature)              \
  _(SupplyLeakage)                   \
  _(SpoolNonlinearity)               \
  _(PressureGain)                    \
  _(PressureGainTemperature)         \
  _(PressureGainDrift)               \
  _(PressureOffsetTemperature)       \
  _(PressureCrosstalk)               \
  _(PressurePositionCrosstalk)       \
  _(PressureNonlinearity)            \
  _(PositionNonlinearity)            \
  _(DisplacementGainTemperature)     \
  _(SpoolNullTemperature)            \
  _(SpoolNullPressure)               \
  _(FlowGainPressure)                \
  _(PressureOffsetDrift)             \
  _(PressureSignalLag)               \
  _(SpoolSignalLag)                  \
  _(PositionSignalLag)               \
  _(SignalLag)                       \
  _(PeriodicDisturbance)             \
  _(BulkModulusDrift)                \
  _(DeadVolumeDrift)                 \
  _(FlowGainDrift)                   \
  _(SpoolNullDrift)

namespace hydroscope::effects {

/// What laws of the oil's temperature need: strokes over which it warms by so many K.
inline Effect::LeastSpan OilWarmsBy(double kelvin) {
  return {kOilTemperature, kelvin, {"the oil", "das Öl"}, "K"};
}

/// Pressure that a parameter which follows it is stated at, Pa.
inline constexpr double kStatedAtPressure = 100e5;

/// Polytropic exponent of a gas that nobody has measured: isothermal 1.0 to adiabatic 1.4, all alike likely.
inline constexpr double kPolytropic = 1.2, kPolytropicStd = 0.115;

/// Columns of the base balance, in their order.
enum BaseColumn { kFlowArea, kDeadVolume, kStrokeVolume, kFlowNull };

/// Weights of an effect whose columns are what it does to these of the base balance.
template <BaseColumn... kColumns>
std::vector<double> WeightsOf(const ShapeContext& c) {
  return {c.theta[kColumns]...};
}
/// ... to all four.
inline constexpr auto BaseWeights = WeightsOf<kFlowArea, kDeadVolume, kStrokeVolume, kFlowNull>;

#define HYDROSCOPE_DECLARE_EFFECT(Name) Effect Name(const CushionGeometry&);
HYDROSCOPE_STORED_EFFECTS(HYDROSCOPE_DECLARE_EFFECT)
HYDROSCOPE_SAMPLE_EFFECTS(HYDROSCOPE_DECLARE_EFFECT)
#undef HYDROSCOPE_DECLARE_EFFECT

}  // namespace hydroscope::effects
