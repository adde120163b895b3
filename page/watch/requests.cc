#include "page/watch/requests.h"

#include <algorithm>
#include <charconv>

#include "core/told_error.h"
#include "page/http/json_arguments.h"

namespace hydroscope {
namespace {

constexpr std::int64_t kLargest = std::int64_t{1} << 53;  ///< that JSON numbers hold

using Action = AlarmRequest::Action;

constexpr std::pair<const char*, Action> kActions[] = {{"acknowledge", Action::kAcknowledge},
                                                       {"shelve", Action::kShelve},
                                                       {"unshelve", Action::kUnshelve},
                                                       {"comment", Action::kComment}};
/// s: what is put aside for longer is out of service (`alarms out-of-service`).
constexpr double kLongestShelf = 31 * 86400.0;

}  // namespace

Result<std::optional<std::int64_t>> WholeNumberOf(const std::map<std::string, std::string>& query,
                                                  const char* name) {
  const auto found = query.find(name);
  if (found == query.end() || found->second.empty()) return std::optional<std::int64_t>();
  const std::string& text = found->second;
  std::int64_t number = 0;
  const auto read = std::from_chars(text.data(), text.data() + text.size(), number);
  if (read.ec != std::errc() || read.ptr != text.data() + text.size() || number < 0 || number > kLargest)
    return BadInput("{}: expected a whole number from 0", name);
  return std::optional<std::int64_t>(number);
}

Result<TrendQuestion> ParseTrendQuestion(const std::map<std::string, std::string>& query) {
  const auto text = [&](const char* name) {
    const auto found = query.find(name);
    return found == query.end() ? std::string() : found->second;
  };
  TrendQuestion question;
  question.machine = text("machine");
  question.parameter = text("parameter");
  if (question.parameter.empty()) return BadInput("parameter: expected the name of a parameter");
  const auto first = WholeNumberOf(query, "first"), end = WholeNumberOf(query, "end"),
             bins = WholeNumberOf(query, "bins");
  for (const auto* number : {&first, &end, &bins})
    if (!*number) return tl::unexpected(number->error());
  question.first = first->value_or(question.first);
  question.end = end->value_or(question.end);
  question.bins = std::clamp<std::int64_t>(bins->value_or(question.bins), 1, TrendQuestion::kMostBins);
  return question;
}

Result<LearnRequest> ParseLearnRequest(const std::string& body) {
  const auto strokes = TRY(ParseStrokeStretch(body));
  const auto json = TRY(ParseObject(body));
  const auto only_look = FlagOf(json, "only_look"), insist = FlagOf(json, "insist");
  for (const auto* flag : {&only_look, &insist})
    if (!*flag) return tl::unexpected(flag->error());
  const auto user = TextOf(json, "user"), comment = TextOf(json, "comment", kLongestComment);
  for (const auto* text : {&user, &comment})
    if (!*text) return tl::unexpected(text->error());
  if (*insist && comment->find_first_not_of(" \t\n") == std::string::npos)
    return BadInput(
        Told("comment: expected why these strokes are learned in spite of what speaks against them",
             "Bemerkung: erwartet: warum diese Hübe gelernt werden, obwohl etwas dagegen spricht"));
  return LearnRequest{strokes, *only_look, *insist, *user, *comment};
}

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
