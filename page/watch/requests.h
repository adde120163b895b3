#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "core/result.h"
#include "page/api_arguments.h"

namespace hydroscope {

/// A whole number from 0 to 2^53 under `name` of a query; nothing if absent. Error: it is none.
Result<std::optional<std::int64_t>> WholeNumberOf(const std::map<std::string, std::string>& query,
                                                  const char* name);

/// What is asked of a trend.
struct TrendQuestion {
  static constexpr std::int64_t kMostBins = 4000;

  std::string machine, parameter;
  std::int64_t first = 0, end = -1;  ///< strokes; end -1: all there are
  std::int64_t bins = 1000;
};
/// Of the query `machine`, `parameter`, `first`, `end`, `bins`. Errors name the key and what was expected.
Result<TrendQuestion> ParseTrendQuestion(const std::map<std::string, std::string>& query);

/// Strokes that a person takes for those of the healthy machine.
struct LearnRequest {
  StrokeStretch strokes;
  bool only_look = false;  ///< tell what speaks against it, learn nothing
  bool insist = false;     ///< learn in spite of what refuses
  std::string user;        ///< "" = who is logged in
  std::string comment;     ///< why
};
/// Of {"machine", "first", "last", "only_look", "insist", "user", "comment"}. Who insists says why. Errors name the key and
/// what was expected.
Result<LearnRequest> ParseLearnRequest(const std::string& body);

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
