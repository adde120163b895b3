#pragma once

#include <memory>
#include <string>
#include <vector>

#include "alarms/feeds/feed_reader.h"
#include "alarms/health_board.h"
#include "core/clock.h"
#include "models/machine.h"

namespace hydroscope {

/// What feeds are made of.
struct FeedContext {
  const Machine& machine;  ///< whose [feeds] are asked for
  std::string database;
  Clock clock;
  /// What the service knows of health; nullptr: only the journal is asked.
  std::shared_ptr<const HealthBoard> board;

  /// Another handle on journal and trends.
  FeedReader Reader() const {
    std::vector<std::string> axes;
    for (int axis = 0; axis < AxisCount(machine); ++axis) axes.push_back(AxisMachineName(machine, axis));
    const std::string press = axes.size() > 1 ? machine.name : "";
    return FeedReader(std::move(axes), press, database, board);
  }
};

}  // namespace hydroscope
