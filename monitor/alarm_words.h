#pragma once

#include <string>

#include "core/alarm_records.h"
#include "diagnosis/drift/rules.h"

namespace hydroscope {

/// The sentences of an alarm's text (FindingWords) by what they tell. Of an alarm that no rule raises all of it is `finding`.
struct AlarmWords {
  std::string finding;  ///< "Oil column softer"
  std::string
      evidence;  ///< "since stroke 48210: K -10.0 ± 0.6 % (12000 -> 10800 bar)", what comparing strokes said
  std::string action;  ///< guidance of the rule
};
AlarmWords WordsOf(const AlarmState& alarm, const drift::RuleBook& rules);

}  // namespace hydroscope
