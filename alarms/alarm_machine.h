#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/records/alarm_records.h"

namespace hydroscope {

struct AlarmSettings {
  int on_delay = 5;     ///< strokes the condition must hold
  int off_delay = 30;   ///< strokes it must be gone
  double deadband = 2;  ///< standard deviations inside the limit before it counts as gone
  bool latching = false;
};

/// What a stroke says about an alarm's condition.
struct AlarmCondition {
  double value = 0, std = 0, limit = 0;  ///< SI
  bool high = true;                      ///< alarm above the limit; false: below
  std::string unit;
  AlarmSeverity severity = AlarmSeverity::kWarning;
  std::string text;
  std::int64_t first_stroke = -1, last_stroke = -1;
  AlarmCause cause = {};
  AlarmWords words = {};
  std::vector<std::string> quantities = {};  ///< parameters and effects it speaks of
  /// SI, what the deadband is counted in where `std` holds more than changes from stroke to stroke; nothing: `std`.
  std::optional<double> scatter = {};

  /// One sentence is all there is to say.
  void Say(Told sentence) {
    text = sentence.english;
    words = {std::move(sentence), {}, {}};
  }
};

/// Where and when: machine time and stroke, wall clock, oil temperature.
struct AlarmMoment {
  double time = 0;  ///< s
  double wall = 0;  ///< s since 1970
  std::int64_t stroke = -1;
  double oil_temperature = 0;  ///< K
  int model_version = 0, reference_version = 0;
};

/// Who did it and why.
struct AlarmUser {
  std::string name, comment;
};

/// The state machine of ISA-18.2 on one alarm; pure: every function takes the moment as argument, changes the
/// flags and returns what is to be journalled. Flags are tracked below a shelf, a suppression or
/// out-of-service, so that nothing is forgotten when that ends; what changed below is journalled too.
namespace alarm_machine {

using Events = std::vector<AlarmEvent>;

/// A stroke's condition. A raise that follows a return makes the alarm unacknowledged again; a rise in
/// severity too.
Events Observe(AlarmState& alarm, const AlarmSettings& settings, const AlarmCondition& condition,
               const AlarmMoment& now);
/// The cause is known to be gone: clears at once, without off-delay.
Events Clear(AlarmState& alarm, const AlarmSettings& settings, const AlarmMoment& now);
/// Nothing to acknowledge: no event.
Events Acknowledge(AlarmState& alarm, const AlarmUser& user, const AlarmMoment& now);
Events Shelve(AlarmState& alarm, double until, const AlarmUser& user, const AlarmMoment& now);
Events Unshelve(AlarmState& alarm, const AlarmUser& user, const AlarmMoment& now);
/// Ends a shelf whose time is over.
Events Tick(AlarmState& alarm, const AlarmMoment& now);
Events Suppress(AlarmState& alarm, Suppression reason, bool on, const AlarmMoment& now);
Events SetOutOfService(AlarmState& alarm, bool on, const AlarmUser& user, const AlarmMoment& now);
/// A remark for the journal; nothing of the alarm changes.
Events Comment(AlarmState& alarm, const AlarmUser& user, const AlarmMoment& now);
/// Ends a latch; only after the condition has gone.
Events Reset(AlarmState& alarm, const AlarmUser& user, const AlarmMoment& now);

}  // namespace alarm_machine

/// Nothing to show to anybody: not active, nothing to acknowledge or reset, not shelved, in service. A suppressed alarm
/// without cause is at rest too.
bool AtRest(const AlarmState& alarm);

}  // namespace hydroscope
