#include "alarms/feeds/feeds.h"

#include "alarms/feeds/dds/dds_feed.h"
#include "alarms/feeds/modbus/modbus_feed.h"
#include "alarms/feeds/sparkplug/sparkplug_feed.h"
#include "storage/outbox.h"

namespace hydroscope {

Feeds Feeds::Start(const Machine& machine, const std::string& database, const Clock& clock,
                   std::shared_ptr<const HealthBoard> board) {
  Feeds started;
  if (!machine.feeds) return started;
  std::vector<std::string> axes;
  for (int axis = 0; axis < AxisCount(machine); ++axis) axes.push_back(AxisMachineName(machine, axis));
  const std::string press = axes.size() > 1 ? machine.name : "";
  const auto reader = [&] { return FeedReader(axes, press, database, board); };
  if (const auto& modbus = machine.feeds->modbus)
    started.feeds_.push_back(MakeModbusFeed(*modbus, reader(), clock));
  if (const auto& dds = machine.feeds->dds) started.feeds_.push_back(MakeDdsFeed(*dds, reader(), clock));
  if (auto sparkplug = machine.feeds->sparkplug) {
    if (sparkplug->node.empty()) sparkplug->node = machine.name;
    started.feeds_.push_back(MakeSparkplugFeed(*sparkplug, reader(), Outbox::PathFor(database), clock));
  }
  return started;
}

std::vector<FeedStatus> Feeds::status() const {
  std::vector<FeedStatus> all;
  for (const auto& feed : feeds_) all.push_back(feed->status());
  return all;
}

}  // namespace hydroscope
