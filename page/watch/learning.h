#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>

#include "page/watch/requests.h"
#include "page/watch/watch_options.h"
#include "page/work/job_queue.h"

namespace hydroscope {

/// Learns references from the page as `hydroscope learn` does, as jobs: the strokes are explained first. Safe from any thread.
class Learning {
 public:
  Learning(const WatchOptions& options, JobQueue& jobs);
  /// The job's number. What comes of it, Last tells.
  Result<std::int64_t> Start(const LearnRequest& request);
  /// What the last look at strokes of this machine found: `first`, `last`, `doubts` (`kind`, `text`, `refuses`), `refused`,
  /// `learned` (as `learn --json`; null: nothing was). Null: nobody looked.
  nlohmann::json Last(const std::string& machine) const;

 private:
  /// Outlives the object while a job runs.
  struct Found {
    std::mutex mutex;
    std::map<std::string, nlohmann::json> last;  ///< by machine
  };
  const std::string database_, machine_file_;
  JobQueue& jobs_;
  const std::shared_ptr<Found> found_ = std::make_shared<Found>();
};

}  // namespace hydroscope
