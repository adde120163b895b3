#pragma once

#include <span>

#include "diagnosis/experiment/machine_moves.h"
#include "models/model_structure.h"

namespace hydroscope {

/// One stroke that nobody has recorded yet.
struct PlayedStroke {
  double speed = 0;                   ///< m/s, of the ram
  double rod = 0;                     ///< Pa, in chamber B
  double oil = 0;                     ///< K
  double begin = 0;                   ///< s, on the time of the strokes recorded
  std::span<const double> pressures;  ///< Pa, in chamber A, in equal parts of the stroke
};

enum class SensorNoise { kNone, kAsRecorded };

/// Plays one stroke through, without sensor noise or with white noise as recorded: the spool stands where the
/// base balance of the die cushion with parameters `theta` wants it. Pressures that would open it too far are
/// raised; spans in which the gate would shut are left out.
StrokeStretches Play(const ModelStructure& model, const Eigen::VectorXd& theta, const WindowSamples& window,
                     const MachineMoves& moves, const PlayedStroke& played,
                     SensorNoise noise = SensorNoise::kNone);

}  // namespace hydroscope
