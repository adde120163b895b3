#pragma once

#include <string>

#include "core/result.h"

namespace hydroscope {

/// What a person wants of an alarm.
struct AlarmRequest {
  enum class Action { kAcknowledge, kShelve, kUnshelve, kComment };
  Action action = Action::kAcknowledge;
  std::string machine, alarm;
  std::string user;  ///< "" = who started the program
  std::string comment;
  double seconds = 0;  ///< kShelve: how long
};
/// Of {"action": "acknowledge" | "shelve" | "unshelve" | "comment", "machine", "alarm", "user", "comment", "seconds"}. A
/// shelf needs a time of up to a month and a reason, a comment its text. Errors name the key and what was expected.
Result<AlarmRequest> ParseAlarmRequest(const std::string& body);

}  // namespace hydroscope
