#pragma once

#include <string>
#include <vector>

#include "review/replay_runner.h"
#include "simulator/die_cushion/press_options.h"

namespace hydroscope {

/// A folder that goes when the study is over.
class WorkFolder {
 public:
  WorkFolder();
  ~WorkFolder();
  WorkFolder(const WorkFolder&) = delete;
  WorkFolder& operator=(const WorkFolder&) = delete;
  std::string File(const std::string& name) const;

 private:
  std::string path_;
};

/// Simulates one log for each of `runs`, all of the machine of the first, as files in `folder`, and replays
/// them into `database`, with a report if `report` is no empty path.
Result<ReplayOutcome> ReplaySimulated(const std::vector<PressOptions>& runs, const WorkFolder& folder,
                                      const std::string& database, const std::string& report);

}  // namespace hydroscope
