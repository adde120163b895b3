#pragma once

#include <string>
#include <vector>

#include "report/report_words.h"

namespace hydroscope {

/// Takes into the words of a parameter what standing alarms of the drift watch say of it: a change that is young or slow need not
/// stand out over the record as a whole, and one of something else bends the parameters of a model that does not know of it.
/// Limits are judged from the record itself.
void HearAlarms(const std::vector<AlarmState>& alarms, const ParameterAnalysis& analysis,
                const ParameterInfo& info, const CountedWords& counted, ParameterWords& words);

/// "<b>internal_leakage</b> (stroke 290 on)" of each alarm that tells a change of the machine, HTML.
std::vector<std::string> ToldByAlarms(const std::vector<AlarmState>& alarms, const CountedWords& counted);

}  // namespace hydroscope
