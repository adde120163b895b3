#include "alarms/alarm_machine.h"

namespace hydroscope {
namespace {

const char* SuppressionName(Suppression reason) {
  switch (reason) {
    case kSuppressedIdle:
      return "machine idle";
    case kSuppressedValveCheck:
      return "valve check running";
    case kSuppressedTooCold:
      return "oil below the minimum temperature";
    case kSuppressedCommonCause:
      return "all axes changed together";
  }
  return "";
}

/// Notes the state before; Done() is the event with the state after.
class Step {
 public:
  Step(AlarmState& alarm, const AlarmMoment& now) : alarm_(alarm), now_(now), before_(StateName(alarm)) {}

  alarm_machine::Events Done(const char* event, const AlarmUser& user = {}) const {
    AlarmEvent e;
    e.alarm = alarm_.id;
    e.event = event;
    e.state_before = before_;
    e.state = StateName(alarm_);
    e.severity = alarm_.severity;
    e.time = now_.time;
    e.stroke = now_.stroke;
    e.value = alarm_.value;
    e.std = alarm_.std;
    e.limit = alarm_.limit;
    e.unit = alarm_.unit;
    e.oil_temperature = now_.oil_temperature;
    e.model_version = now_.model_version;
    e.reference_version = now_.reference_version;
    e.user = user.name;
    e.comment = user.comment;
    e.text = alarm_.text;
    e.first_stroke = alarm_.first_stroke;
    e.last_stroke = alarm_.last_stroke;
    e.cause = CauseText(alarm_.cause);
    return {e};
  }

 private:
  AlarmState& alarm_;
  const AlarmMoment& now_;
  std::string before_;
};

void Take(AlarmState& alarm, const AlarmCondition& condition) {
  alarm.value = condition.value;
  alarm.std = condition.std;
  alarm.limit = condition.limit;
  alarm.unit = condition.unit;
  alarm.text = condition.text;
  alarm.words = condition.words;
  alarm.first_stroke = condition.first_stroke;
  alarm.last_stroke = condition.last_stroke;
  alarm.cause = condition.cause;
  alarm.quantities = condition.quantities;
}

}  // namespace

namespace alarm_machine {

Events Observe(AlarmState& alarm, const AlarmSettings& settings, const AlarmCondition& condition,
               const AlarmMoment& now) {
  const double sign = condition.high ? 1.0 : -1.0, beyond = sign * (condition.value - condition.limit);
  const bool on = beyond >= 0, off = beyond < -settings.deadband * condition.scatter.value_or(condition.std);
  const Step step(alarm, now);
  if (!alarm.active) {
    alarm.on_count = on ? alarm.on_count + 1 : 0;
    if (!on) return {};
    Take(alarm, condition);
    if (alarm.on_count < settings.on_delay) return {};
    alarm.active = true;
    alarm.acknowledged = false;
    alarm.latched = settings.latching;
    alarm.severity = condition.severity;
    alarm.on_count = alarm.off_count = 0;
    alarm.raised_time = now.time;
    alarm.raised_wall = now.wall;
    alarm.raised_stroke = now.stroke;
    return step.Done("raised");
  }
  Take(alarm, condition);
  alarm.off_count = off ? alarm.off_count + 1 : 0;
  if (alarm.off_count >= settings.off_delay) return Clear(alarm, settings, now);
  if (on && condition.severity > alarm.severity) {
    alarm.severity = condition.severity;
    alarm.acknowledged = false;
    return step.Done("escalated");
  }
  return {};
}

Events Clear(AlarmState& alarm, const AlarmSettings&, const AlarmMoment& now) {
  alarm.on_count = alarm.off_count = 0;
  if (!alarm.active) return {};
  const Step step(alarm, now);
  alarm.active = false;
  return step.Done("cleared");
}

Events Acknowledge(AlarmState& alarm, const AlarmUser& user, const AlarmMoment& now) {
  if (alarm.acknowledged) return {};
  const Step step(alarm, now);
  alarm.acknowledged = true;
  return step.Done("acknowledged", user);
}

Events Shelve(AlarmState& alarm, double until, const AlarmUser& user, const AlarmMoment& now) {
  if (!(until > now.wall)) return {};
  const Step step(alarm, now);
  alarm.shelved_until = until;
  return step.Done("shelved", user);
}

Events Unshelve(AlarmState& alarm, const AlarmUser& user, const AlarmMoment& now) {
  if (!alarm.shelved_until) return {};
  const Step step(alarm, now);
  alarm.shelved_until.reset();
  return step.Done("unshelved", user);
}

Events Tick(AlarmState& alarm, const AlarmMoment& now) {
  if (!alarm.shelved_until || now.wall < *alarm.shelved_until) return {};
  return Unshelve(alarm, {"", "the time is over"}, now);
}

Events Suppress(AlarmState& alarm, Suppression reason, bool on, const AlarmMoment& now) {
  if (((alarm.suppressed & reason) != 0) == on) return {};
  const Step step(alarm, now);
  alarm.suppressed = static_cast<std::uint8_t>(alarm.suppressed ^ reason);
  return step.Done(on ? "suppressed" : "unsuppressed", {"", SuppressionName(reason)});
}

Events SetOutOfService(AlarmState& alarm, bool on, const AlarmUser& user, const AlarmMoment& now) {
  if (alarm.out_of_service == on) return {};
  const Step step(alarm, now);
  alarm.out_of_service = on;
  return step.Done(on ? "out_of_service" : "in_service", user);
}

Events Comment(AlarmState& alarm, const AlarmUser& user, const AlarmMoment& now) {
  if (user.comment.empty()) return {};
  return Step(alarm, now).Done("commented", user);
}

Events Reset(AlarmState& alarm, const AlarmUser& user, const AlarmMoment& now) {
  if (!alarm.latched || alarm.active) return {};
  const Step step(alarm, now);
  alarm.latched = false;
  return step.Done("reset", user);
}

}  // namespace alarm_machine

bool AtRest(const AlarmState& alarm) {
  return !alarm.active && alarm.acknowledged && !alarm.latched && !alarm.shelved_until &&
         !alarm.out_of_service;
}

}  // namespace hydroscope
