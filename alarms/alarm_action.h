#pragma once

#include <functional>
#include <string>

#include "alarms/alarm_machine.h"
#include "storage/alarm_journal.h"

namespace hydroscope {

/// What is done to an alarm, a function of alarm_machine.
using AlarmAction = std::function<alarm_machine::Events(AlarmState&, const AlarmMoment&)>;

/// A person's action on an alarm that the journal knows, with its row, in one transaction: a service that judges strokes
/// meanwhile neither loses nor undoes it. `wall` in s since 1970. False: there was nothing to do. Errors: the journal does
/// not know the alarm, or it cannot be written.
Result<bool> ActOnAlarm(AlarmJournal& journal, const std::string& machine, const std::string& alarm,
                        double wall, const AlarmAction& action);

}  // namespace hydroscope
