#pragma once

#include <cstdint>
#include <string>

namespace hydroscope {

/// Campaigns of the alarm journal and its feeds, on processes of their own with a real MQTT broker
/// (mosquitto). Each prints a table, says what was required and returns 0 if it was reached, else 1.

struct AlarmKillOptions {
  int times = 200;
  std::uint64_t seed = 1;
};
/// kill -9 of a process that writes the journal and feeds its outbox: every acknowledged row there once, no
/// gap, states restored, everything delivered by MQTT at least once under its own number, by DDS nothing that
/// is not in the journal.
int RunAlarmKill(const AlarmKillOptions& options);

/// 1000 alarms in a second: journal whole, feeds in order, a SCADA poller at 1 Hz misses none.
struct AlarmBurstOptions {
  int alarms = 1000;
  double seconds = 1;
};
int RunAlarmBurst(const AlarmBurstOptions& options);

/// The process both watch: feeds on `database` and, as `mode` says, what writes the journal: "load" changes
/// alarms until it is killed, with one line on stdout for each stored change; "burst" raises `alarms` in
/// `seconds` once a line came on stdin, then waits for another; "drain" writes nothing and ends when
/// everything is out.
struct AlarmLoadOptions {
  std::string database, broker, mode = "load";
  int domain = 0;  ///< of DDS
  std::uint64_t seed = 1;
  AlarmBurstOptions burst;
};
int RunAlarmLoad(const AlarmLoadOptions& options);

}  // namespace hydroscope
