#include "page/watch/alarm_request.h"

#include <algorithm>

#include "core/told_error.h"
#include "page/http/json_arguments.h"

namespace hydroscope {
namespace {

using Action = AlarmRequest::Action;

constexpr std::pair<const char*, Action> kActions[] = {{"acknowledge", Action::kAcknowledge},
                                                       {"shelve", Action::kShelve},
                                                       {"unshelve", Action::kUnshelve},
                                                       {"comment", Action::kComment}};
/// s: what is put aside for longer is out of service (`alarms out-of-service`).
constexpr double kLongestShelf = 31 * 86400.0;

}  // namespace

Result<AlarmRequest> ParseAlarmRequest(const std::string& body) {
  const auto json = TRY(ParseObject(body));
  AlarmRequest request;
  const auto action = TextOf(json, "action"), machine = TextOf(json, "machine"),
             alarm = TextOf(json, "alarm"), user = TextOf(json, "user"),
             comment = TextOf(json, "comment", kLongestComment);
  for (const auto* text : {&action, &machine, &alarm, &user, &comment})
    if (!*text) return tl::unexpected(text->error());
  const auto named = std::find_if(std::begin(kActions), std::end(kActions),
                                  [&](const auto& a) { return *action == a.first; });
  if (named == std::end(kActions))
    return BadInput("action: found '{}', expected acknowledge, shelve, unshelve or comment", *action);
  if (alarm->empty()) return BadInput("alarm: expected the id of an alarm");
  const auto seconds = TRY(NumberOf(json, "seconds"));
  request = {named->second, *machine, *alarm, *user, *comment, seconds.value_or(0)};
  const bool shelves = request.action == Action::kShelve;
  if (shelves && !(request.seconds > 0 && request.seconds <= kLongestShelf))
    return BadInput(Told("seconds: expected a time above 0, of at most a month",
                         "Dauer: erwartet eine Zeit über 0, höchstens ein Monat"));
  if ((shelves || request.action == Action::kComment) &&
      request.comment.find_first_not_of(" \t\n") == std::string::npos)
    return BadInput(Tell("comment: expected {}", "Bemerkung: erwartet: {}",
                         shelves ? Told("the reason", "der Grund") : Told("a text", "ein Text")));
  return request;
}

}  // namespace hydroscope
