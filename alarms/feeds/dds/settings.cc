#include "alarms/feeds/dds/settings.h"

#include "alarms/feeds/list.h"
#include "models/machine_file/sections.h"

namespace hydroscope {
namespace {

PartSettings ReadDdsSettings(TableReader& section) {
  DdsFeedSpec dds;
  ReadDdsConnection(section, dds);
  section.Text("topic", dds.topic);
  if (dds.topic.empty()) section.Wrong("topic", "the beginning of the topics' names, e.g. \"hydroscope\"");
  return PartSettings(dds);
}

Pairs WriteDdsSettings(const PartSettings& settings) {
  const DdsFeedSpec& dds = *settings.As<DdsFeedSpec>();
  Pairs pairs = DdsConnectionPairs(dds);
  pairs.emplace_back("topic", Quoted(dds.topic));
  return pairs;
}

}  // namespace

const FeedSection kDdsFeedSection = {.name = DdsFeedSpec::kName,
                                     .comment = "Alarm events and findings by DDS (docs/live_protocol.md).",
                                     .keys = WithDdsConnectionKeys({"topic"}),
                                     .read = ReadDdsSettings,
                                     .write = WriteDdsSettings};

}  // namespace hydroscope
