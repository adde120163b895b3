#include "alarms/alarm_action.h"

#include <algorithm>

#include "core/constants.h"

namespace hydroscope {

Result<bool> ActOnAlarm(AlarmJournal& journal, const std::string& machine, const std::string& alarm,
                        double wall, const AlarmAction& action) {
  bool changed = false;
  TRY(journal.Change(machine, wall, [&](AxisContent& axis) -> Status {
    const auto known =
        std::ranges::find_if(axis.alarms, [&](const AlarmState& state) { return state.id == alarm; });
    if (known == axis.alarms.end())
      return BadInput("the journal knows no alarm \"{}\" of \"{}\"", alarm, machine);
    auto events = action(*known, {kNaN, wall, known->last_stroke, kNaN, 0, 0});
    changed = !events.empty();
    axis.Append(std::move(events));
    return {};
  }));
  return changed;
}

}  // namespace hydroscope
