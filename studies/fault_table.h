#pragma once

#include <functional>
#include <optional>
#include <string>

#include "studies/live/live_rig.h"

namespace hydroscope {

/// Sum of a counter over all axes.
std::int64_t SumOverAxes(const nlohmann::json& status, const char* counter);

/// Runs of the service against the replay of their raw rows.
struct ReplayCount {
  std::int64_t same = 0, different = 0, strokes = 0;
  bool ok() const { return different == 0 && same > 0; }
};
Result<ReplayCount> CountReplays(const std::string& database);
/// Prints it beside the exit code of the service; true if all are the same.
Result<bool> ReplaysAreTheSame(const std::string& database, int exit_code);

/// Faults done to a rig, one printed row each: after how long its values were stale, after how long they were
/// back, and whether that is what was required.
class FaultTable {
 public:
  static constexpr double kPatience = 15.0;  ///< s

  explicit FaultTable(LiveRig& rig);

  /// Something happens to a signal and is undone after `seconds`: stale within two periods, back within two
  /// of the longest pauses between attempts.
  void Cut(const std::string& what, const std::string& signal, double seconds,
           const std::function<void()>& begin, const std::function<void()>& end);
  void Row(const std::string& what, std::optional<double> stale, std::optional<double> back, bool ok,
           const std::string& note);
  int missed() const { return missed_; }

 private:
  LiveRig& rig_;
  int missed_ = 0;
};

}  // namespace hydroscope
