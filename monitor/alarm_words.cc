#include "monitor/alarm_words.h"

#include <algorithm>

namespace hydroscope {
namespace {

/// Takes `part` and what surrounds it of blanks out of `text`. False: it does not stand there.
bool TakeOut(const std::string& part, std::string& text) {
  const std::size_t at = part.empty() ? text.npos : text.rfind(part);
  if (at == text.npos) return false;
  text.erase(at, part.size());
  while (at < text.size() && text[at] == ' ') text.erase(at, 1);
  while (!text.empty() && text.back() == ' ') text.pop_back();
  return true;
}

}  // namespace

AlarmWords WordsOf(const AlarmState& alarm, const drift::RuleBook& rules) {
  AlarmWords words;
  std::string text = alarm.text;
  const auto rule = std::find_if(rules.rules.begin(), rules.rules.end(),
                                 [&](const drift::Rule& r) { return r.id == alarm.id; });
  if (rule != rules.rules.end() && TakeOut(rule->guidance, text)) words.action = rule->guidance;
  if (alarm.cause.kind != CauseKind::kNotSought) TakeOut("Cause: " + CauseText(alarm.cause) + ".", text);
  // "since stroke 48210 (48190 to 48230): Oil column softer; K -10.0 ± 0.6 %, ..." (drift::FindingText)
  const std::size_t colon = text.find(": "), semicolon = text.find("; ");
  if (!text.starts_with("since ") || colon == text.npos || semicolon == text.npos || semicolon < colon) {
    words.finding = text;
    return words;
  }
  words.finding = text.substr(colon + 2, semicolon - colon - 2);
  words.evidence = text.substr(0, colon + 2) + text.substr(semicolon + 2);
  return words;
}

}  // namespace hydroscope
