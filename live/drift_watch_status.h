#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "alarms/health.h"
#include "core/records/estimate_statement.h"
#include "core/told.h"

namespace hydroscope {

/// How one axis stands, for `status`.
struct AxisHealth {
  std::string name;                                ///< "press/cushion_1"; the press itself: "press"
  Health health;                                   ///< the answer of HealthBoard, where there is one
  int reference = 0;                               ///< version; 0: commissioning
  std::int64_t learned = 0;                        ///< strokes commissioning has ...
  std::int64_t needed = 0;                         ///< ... and needs
  std::int64_t judged = 0;                         ///< stroke up to which all are judged
  std::vector<std::string> alarms;                 ///< "UNACK internal_leakage": those that are not at rest
  std::vector<EstimateStatement> statements = {};  ///< how its estimates are stated, of HealthBoard
};

struct DriftWatchStatus {
  Told problem;  ///< why nothing is judged, "" while all is well
  std::vector<AxisHealth> axes;
};

}  // namespace hydroscope
