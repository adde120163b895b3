#pragma once

#include <memory>
#include <string>
#include <vector>

#include "alarms/feeds/feed.h"
#include "alarms/health_board.h"
#include "core/clock.h"
#include "models/machine.h"

namespace hydroscope {

/// The feeds that the machine file names, all reading the database `database` and its journal, each on its
/// own. They run from Start until the object goes; what keeps one from working is told by its status and
/// tried again. `board`: what the service knows of health.
class Feeds {
 public:
  Feeds() = default;
  static Feeds Start(const Machine& machine, const std::string& database, const Clock& clock,
                     std::shared_ptr<const HealthBoard> board = nullptr);

  std::vector<FeedStatus> status() const;

 private:
  std::vector<std::unique_ptr<Feed>> feeds_;
};

}  // namespace hydroscope
