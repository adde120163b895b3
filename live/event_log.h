#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>

#include "live/live_status.h"
#include "storage/alarm_journal.h"

namespace hydroscope {

/// Tells the log what an operator wants to read there later: links and senders that come and go, feeds that are
/// lost and why, who is turned away, and every row of the alarm journal. Compares what the service says with what it said at the
/// look before. One object belongs to one thread.
class EventLog {
 public:
  /// Rows that the journal has by now stand in the log of an earlier life.
  explicit EventLog(std::string journal);

  void Look(const LiveStatus& status);

 private:
  struct Link {
    bool connected = false;
    std::string state;
    bool operator==(const Link&) const = default;
  };
  /// How many of something there were by the last line about it.
  struct Count {
    std::int64_t told = 0, at = 0;  ///< ns, monotonic
  };
  /// A line where `count` has grown, at most one a minute for each event and `who`.
  void TellCount(const char* event, const LogFields::value_type& who, std::int64_t count,
                 const std::string& why, std::int64_t now);
  void LookAtRefusals(const LiveStatus& status);
  void LookAtSenders(const LiveStatus& status);
  void LookAtEstimates(const LiveStatus& status);
  void LookAtJournal();

  std::string journal_path_;
  std::optional<AlarmJournal> journal_;
  std::optional<std::int64_t> told_;  ///< sequence of the newest row in the log
  std::map<std::string, Link> sources_, feeds_;
  std::map<SenderId, std::string> senders_;
  std::map<std::string, Count> counts_;
  std::set<std::string> doubtful_;  ///< axes whose estimates were warned of
};

}  // namespace hydroscope
