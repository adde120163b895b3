#include <algorithm>
#include <iostream>
#include <random>

#include "alarms/alarm_machine.h"
#include "alarms/feeds/dds/settings.h"
#include "alarms/feeds/feeds.h"
#include "alarms/feeds/modbus/settings.h"
#include "alarms/feeds/sparkplug/settings.h"
#include "host/output.h"
#include "host/real_clock.h"
#include "storage/alarm_journal.h"
#include "studies/alarms/alarm_benchmarks.h"
#include "studies/alarms/alarm_rig.h"

namespace hydroscope {
namespace {

constexpr int kAlarmsPerAxis = 10;     // of the load
constexpr int kChunks = 20;            // transactions of a burst
constexpr double kDrainPatience = 60;  // s

double Wall() { return static_cast<double>(RealTime().wall_ns) * 1e-9; }

Machine PressWithFeeds(const AlarmLoadOptions& o) {
  Machine machine;
  machine.name = "press";
  LiveSpec& live = machine.live.emplace();
  for (int axis = 0; axis < kAlarmAxes; ++axis) live.axes.push_back(AlarmAxis(axis).substr(6));
  PartsSpec& feeds = machine.feeds.emplace();
  feeds.Add<ModbusFeedSpec>().port = 0;
  feeds.Add<SparkplugFeedSpec>().broker = o.broker;
  auto& dds = feeds.Add<DdsFeedSpec>();
  dds.domain = o.domain;
  dds.topic = AlarmListener::kTopic;
  dds.transport = DdsTransport::kUdp;
  return machine;
}

alarm_machine::Events Raise(AlarmState& alarm, const AlarmMoment& now) {
  return alarm_machine::Observe(alarm, {.on_delay = 1},
                                {.value = 2,
                                 .std = 0.1,
                                 .limit = 1,
                                 .unit = "1",
                                 .severity = AlarmSeverity::kAlarm,
                                 .text = "campaign",
                                 .first_stroke = now.stroke,
                                 .last_stroke = now.stroke},
                                now);
}

/// One of the things that happen to an alarm, as far as its state allows it.
alarm_machine::Events Disturb(AlarmState& alarm, int what, const AlarmMoment& now) {
  const AlarmUser user{"campaign", ""};
  switch (what) {
    case 0:
      return alarm_machine::Acknowledge(alarm, user, now);
    case 1:
      return alarm_machine::Shelve(alarm, std::floor(now.wall) + 36'000, user, now);
    case 2:
      return alarm_machine::Unshelve(alarm, user, now);
    case 3:
      return alarm_machine::SetOutOfService(alarm, !alarm.out_of_service, user, now);
    default:
      return alarm.active ? alarm_machine::Clear(alarm, {}, now) : Raise(alarm, now);
  }
}

/// "stored TAG MACHINE ALARM STATE SHELVED_UNTIL" for each change that Change() has acknowledged.
int Load(AlarmJournal& journal, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  for (int k = 0;; ++k) {
    const std::string machine = AlarmAxis(static_cast<int>(random() % kAlarmAxes));
    const std::string id = fmt::format("alarm_{}", random() % kAlarmsPerAxis);
    const int what = static_cast<int>(random() % 6);
    const std::string tag = fmt::format("{}-{}", seed, k);
    std::string said;
    const Status stored = journal.Change(machine, Wall(), [&](AxisContent& axis) -> Status {
      AlarmState& alarm = axis.Alarm(id);
      auto events = Disturb(alarm, what, {.time = Wall(), .wall = Wall(), .stroke = k});
      for (AlarmEvent& event : events) event.comment = tag;
      if (!events.empty())
        said = fmt::format("stored {} {} {} {} {:.0f}\n", tag, machine, id, StateName(alarm),
                           alarm.shelved_until.value_or(0));
      axis.Append(std::move(events));
      return {};
    });
    if (!stored) return ReportError(stored.error());
    if (std::fwrite(said.data(), 1, said.size(), stdout) != said.size() || std::fflush(stdout) != 0) return 1;
  }
}

int Burst(AlarmJournal& journal, const Feeds& feeds, const AlarmBurstOptions& o) {
  const auto ready = [&] {
    const auto all = feeds.status();
    return std::ranges::all_of(all, [](const FeedStatus& feed) { return feed.connected; });
  };
  while (!ready()) Sleep(0.02);
  for (const FeedStatus& feed : feeds.status()) std::cout << feed.name << std::endl;
  std::string line;
  std::getline(std::cin, line);
  const double begin = Now();
  for (int chunk = 0; chunk < kChunks; ++chunk) {
    const int first = chunk * o.alarms / kChunks, last = (chunk + 1) * o.alarms / kChunks;
    const Status stored =
        journal.Change(AlarmAxis(chunk % kAlarmAxes), Wall(), [&](AxisContent& axis) -> Status {
          for (int k = first; k < last; ++k)
            axis.Append(
                Raise(axis.Alarm(fmt::format("alarm_{}", k)), {.time = Wall(), .wall = Wall(), .stroke = k}));
          return {};
        });
    if (!stored) return ReportError(stored.error());
    Sleep(std::max(0.0, begin + (chunk + 1) * o.seconds / kChunks - Now()));
  }
  std::cout << fmt::format("raised in {:.3f}", Now() - begin) << std::endl;
  std::getline(std::cin, line);
  return 0;
}

int Drain(const Feeds& feeds) {
  const double end = Now() + kDrainPatience;
  while (Now() < end) {
    const auto all = feeds.status();
    if (std::ranges::all_of(all, [](const FeedStatus& f) { return f.connected && f.behind == 0; })) return 0;
    Sleep(0.05);
  }
  return 1;
}

}  // namespace

int RunAlarmLoad(const AlarmLoadOptions& o) {
  auto journal = AlarmJournal::Open(AlarmJournal::PathFor(o.database));
  if (!journal) return ReportError(journal.error());
  const Feeds feeds = Feeds::Start(PressWithFeeds(o), o.database, RealTime);
  if (o.mode == "burst") return Burst(*journal, feeds, o.burst);
  return o.mode == "drain" ? Drain(feeds) : Load(*journal, o.seed);
}

}  // namespace hydroscope
