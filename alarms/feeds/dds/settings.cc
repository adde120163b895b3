#include "alarms/feeds/dds/settings.h"

#include <fmt/format.h>

#include "alarms/feeds/list.h"
#include "models/machine_file/sections.h"

namespace hydroscope {
namespace {

PartSettings ReadDdsSettings(TableReader& section) {
  DdsFeedSpec dds;
  section.Integer("domain", dds.domain, 0, 232);
  section.Text("topic", dds.topic);
  if (dds.topic.empty()) section.Wrong("topic", "the beginning of the topics' names, e.g. \"hydroscope\"");
  ReadTransport(section, dds.transport);
  section.Texts("interfaces", dds.interfaces);
  section.Texts("peers", dds.peers);
  section.Text("security", dds.security);
  return PartSettings(dds);
}

Pairs WriteDdsSettings(const PartSettings& settings) {
  const DdsFeedSpec& dds = *settings.As<DdsFeedSpec>();
  return {{"domain", Plain(dds.domain)},
          {"topic", Quoted(dds.topic)},
          {"transport", TransportName(dds.transport)},
          {"interfaces", QuotedList(dds.interfaces)},
          {"peers", QuotedList(dds.peers)},
          {"security", Quoted(dds.security)}};
}

}  // namespace

const FeedSection kDdsFeedSection = {
    .name = DdsFeedSpec::kName,
    .comment = "Alarm events and findings by DDS (docs/live_protocol.md).",
    .keys = {"domain", "topic", "transport", "interfaces", "peers", "security"},
    .read = ReadDdsSettings,
    .write = WriteDdsSettings};

}  // namespace hydroscope
