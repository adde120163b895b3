#pragma once

#include <hydroscope_wire/hydroscope_alarms.h>

#include "alarms/feeds/feed_reader.h"

namespace hydroscope {

/// A row of the journal as <topic>/alarms tells it.
hydroscope_wire::AlarmEvent ToWire(const JournalRow& row);
/// An alarm as <topic>/findings tells it.
hydroscope_wire::Finding ToWire(const AxisPicture& axis, const AlarmState& alarm);
/// The finding without a name that tells the health of an axis, also of one without alarms.
AlarmState HealthAsAlarm(const Health& health);

}  // namespace hydroscope
