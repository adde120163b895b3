#include "report/heard_alarms.h"

#include <fmt/format.h>

#include <cmath>

#include "core/contains.h"
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
  return TellsOfParameters(alarm) && Contains(told, parameter);
}

/// What the estimates did since an alarm says that something else changed; "" = nothing that stands out.
std::string MovedWith(const AlarmState& alarm, const ParameterAnalysis& analysis, const ParameterInfo& info,
                      const CountedWords& counted) {
  if (alarm.out_of_service || !TellsAChange(alarm)) return "";
  const TestedValue change = ChangeSince(analysis.samples, alarm.first_stroke);
  if (SignificanceOf(change) != Significance::kClear) return "";
  return fmt::format(
      "Since {} {}, when <b>{}</b> began, the estimate has moved by {}{}. A change that the model does not know bends its "
      "parameters: it need not be one of this parameter. ",
      counted.one, FormatCount(alarm.first_stroke), EscapeText(alarm.id),
      FormatWithUncertainty(change.value * info.factor, change.HalfWidth() * std::abs(info.factor)),
      info.unit.empty() ? "" : " " + EscapeText(info.unit));
}

}  // namespace

void HearAlarms(const std::vector<AlarmState>& alarms, const ParameterAnalysis& analysis,
                const ParameterInfo& info, const CountedWords& counted, ParameterWords& words) {
  if (words.standing >= Standing::kChanged) return;
  std::string told, moved;
  for (const AlarmState& alarm : alarms)
    if (SpeaksOf(alarm, analysis.parameter))
      told += fmt::format("The alarm <b>{}</b> tells a change since {} {}. ", EscapeText(alarm.id),
                          counted.one, FormatCount(alarm.first_stroke));
    else
      moved += MovedWith(alarm, analysis, info, counted);
  if (told.empty() && moved.empty()) return;
  words.reading = told + moved +
                  (words.standing == Standing::kSteady ? "Over the record as a whole it does not stand out."
                                                       : words.reading);
  words.standing = Standing::kChanged;
  words.pill = told.empty() ? "moved with the alarm" : "alarm stands";
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
