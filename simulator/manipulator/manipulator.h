#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "core/result.h"
#include "simulator/manipulator/controller.h"
#include "simulator/manipulator/motion.h"
#include "simulator/manipulator/plant.h"

namespace hydroscope {

/// What can be hidden in the simulated manipulator.
struct ManipulatorEffectInfo {
  std::string id, unit;  ///< SI unit of the size
  double typical_size;
  std::string law;
};
const std::vector<ManipulatorEffectInfo>& ManipulatorEffects();

/// Hides an effect, "payload" or "payload=80". Error: an unknown one, a size that is no number, or below 0.
Status HideEffect(const std::string& text, ManipulatorTruth& truth);

struct ManipulatorNoise {
  double q = 1e-5;      ///< rad
  double p = 2e4;       ///< Pa, chambers and supply
  double spool = 2e-4;  ///< of full opening
};

struct ManipulatorOptions {
  ManipulatorTruth truth = PublishedManipulator();
  ManipulatorMotion motion = DrawnMotion(1);
  ControllerModel model = DatasheetModel(PublishedManipulator());
  ControllerRates rates;
  ManipulatorNoise noise;
  double seconds = 60;
  double sample_period = 0.004;  ///< s, a multiple of the controller's
  std::uint64_t seed = 1;        ///< of the noise
};
Status Validate(const ManipulatorOptions& options);

/// One row of a log.
struct ManipulatorRow {
  double time = 0;  ///< s
  ManipulatorReadings readings;
};

/// How well the tip followed, m and m/s; the first seconds, in which the filters settle, left out.
struct TrackingError {
  double rms = 0, largest = 0, largest_speed = 0;
};

struct ManipulatorLog {
  std::vector<ManipulatorRow> rows;
  TrackingError tracking;
};

ManipulatorLog SimulateManipulator(const ManipulatorOptions& options);

/// t,q_1,q_2,p_11,p_12,p_21,p_22,y_1,y_2,p_s in s, rad, Pa and 1.
inline constexpr const char* kManipulatorLogHeader = "t,q_1,q_2,p_11,p_12,p_21,p_22,y_1,y_2,p_s\n";
void AppendManipulatorLine(const ManipulatorRow& row, std::string& text);

/// Every parameter that can be identified, with its true value, SI; those of joint i end in _i.
std::vector<std::pair<std::string, double>> TrueParameters(const ManipulatorTruth& truth);

}  // namespace hydroscope
