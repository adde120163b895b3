#include "report/heard_alarms.h"

#include <fmt/format.h>

#include <algorithm>

#include "report/svg_text.h"
#include "workbench/history/stored_change.h"

namespace hydroscope {
namespace {

bool TellsOfParameters(const AlarmState& alarm) {
  return alarm.active && !alarm.out_of_service && !alarm.quantities.empty() &&
         alarm.id.find('.') == std::string::npos;
}

bool SpeaksOf(const AlarmState& alarm, const std::string& parameter) {
  const auto& told = alarm.quantities;
  return TellsOfParameters(alarm) && std::find(told.begin(), told.end(), parameter) != told.end();
}

}  // namespace

void HearAlarms(const std::vector<AlarmState>& alarms, const std::string& parameter,
                const CountedWords& counted, ParameterWords& words) {
  if (words.standing >= Standing::kChanged) return;
  std::string told;
  for (const AlarmState& alarm : alarms)
    if (SpeaksOf(alarm, parameter))
      told += fmt::format("The alarm <b>{}</b> tells a change since {} {}. ", EscapeText(alarm.id),
                          counted.one, FormatCount(alarm.first_stroke));
  if (told.empty()) return;
  words.reading =
      told + (words.standing == Standing::kSteady ? "Over the record as a whole it does not stand out."
                                                  : words.reading);
  words.standing = Standing::kChanged;
  words.pill = "alarm stands";
  words.by_alarm = true;
}

std::vector<std::string> ToldByAlarms(const std::vector<AlarmState>& alarms, const CountedWords& counted) {
  std::vector<std::string> told;
  for (const AlarmState& alarm : alarms)
    if (TellsAChange(alarm) || TellsOfParameters(alarm))
      told.push_back(fmt::format("<b>{}</b> ({} {} on)", EscapeText(alarm.id), counted.one,
                                 FormatCount(alarm.first_stroke)));
  return told;
}

}  // namespace hydroscope
