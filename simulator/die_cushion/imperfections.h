#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/result.h"
#include "simulator/die_cushion/effects.h"
#include "simulator/die_cushion/press_options.h"

namespace hydroscope {

/// K, 40 degC, at which what follows the oil is as it should be.
inline constexpr double kWarmOil = 313.15;

/// What a plant has and a clean simulation lacks. Names of the command line: kPressImperfections.
enum class ImperfectionKind {
  // The machine
  kReturnLineResistance,
  kTankPressure,
  kCheckValve,
  kLaminarEdge,
  kBulkModulusSlope,
  kLeakageTemperature,
  kSupplyLeakage,
  kFlowRipple,
  kBulkModulusDrift,
  kBulkModulusTemperature,
  kVolumeDrift,
  kFlowGainDrift,
  kBulkModulusStep,
  kVolumeStep,
  kFlowGainStep,
  kSpoolZeroStep,
  kSpoolZeroDrift,
  kSpoolZeroTemperature,
  kIntermittentLeakage,
  kIntermittentEffects,
  kLeakyStretch,
  kQuadraticRelief,
  kRectangularZone,
  kExponentialViscosity,
  kTwoGainSpool,
  kWrongArea,
  // Signals before the noise of their sensor
  kPressureLag,
  kSpoolLag,
  kPositionLag,
  kSignalLag,
  kOneSignalEarly,
  kPressureZero,
  kPressureGain,
  kPressureGainTemperature,
  kPressureGainDrift,
  kPressureZeroDrift,
  kPressureZeroTemperature,
  kPressureCrosstalk,
  kDisplacementGainTemperature,
  kSpoolBend,
  kPressureBend,
  kPositionBend,
  kSpoolPressure,
  kFlowGainPressure,
  kSensorHum,
  kBadStretch,
  kFrozen,
  // Noise
  kColouredNoise,
  kHeavyTails,
  // The reading and its transport
  kPlcFilter,
  kSpikes,
  kSaturation,
  kQuantisation,
  kSlowTask,
  kDeadband,
  kStuck,
  kWrongUnit,
  kTimeJitter,
  kDroppedRows,
  kSlowSampling,
  kSlowControl,
  kCalmPressure,
};

/// One kind: how it is called, what its size means, and its further numbers.
struct ImperfectionInfo {
  ImperfectionKind kind;
  std::string name;
  std::string unit;     ///< SI unit of the size
  double typical_size;  ///< what a plant has
  double low, high;     ///< sizes taken
  std::string law;      ///< one line
  std::vector<EffectExtra> extras;
  std::string channel;  ///< of kPressChannels or "all", where not said; empty: acts on no channel
};

/// All kinds in the order of the documentation.
const std::vector<ImperfectionInfo>& PressImperfections();

/// An imperfection ready for use.
struct Imperfection {
  ImperfectionKind kind = ImperfectionKind::kReturnLineResistance;
  double size = 0;
  std::vector<double> extras;  ///< in the order of ImperfectionInfo::extras
  std::optional<int> channel;  ///< of kPressChannels; nullopt: all
};

/// Reads the settings; an unknown kind, number or channel is an error that suggests the nearest known one,
/// and a size out of range names the limits.
Result<std::vector<Imperfection>> ResolveImperfections(const std::vector<ImperfectionSetting>& settings);

/// The first of that kind, nullptr if there is none.
const Imperfection* FindImperfection(const std::vector<Imperfection>& list, ImperfectionKind kind);

}  // namespace hydroscope
