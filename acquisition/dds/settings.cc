#include "acquisition/dds/settings.h"

#include <fmt/format.h>

#include "acquisition/list.h"
#include "models/machine_file/sections.h"

namespace hydroscope {
namespace {

PartSettings ReadDdsSource(TableReader& section) {
  DdsSpec dds;
  ReadDdsConnection(section, dds);
  section.Text("topic", dds.topic);
  if (dds.topic.empty()) section.Wrong("topic", "the name of a topic, e.g. \"hydroscope/samples\"");
  section.Flag("backlog", dds.backlog);
  section.Number("deadline", dds.deadline, kSecondsAboveZero);
  section.Texts("senders", dds.senders);
  CheckAddressRanges(section, "senders", dds.senders);
  return PartSettings(dds);
}

Pairs WriteDdsSource(const PartSettings& settings) {
  const DdsSpec& dds = *settings.As<DdsSpec>();
  Pairs pairs = DdsConnectionPairs(dds);
  pairs.insert(pairs.end(), {{"topic", Quoted(dds.topic)},
                             {"backlog", Plain(dds.backlog)},
                             {"deadline", Plain(dds.deadline)},
                             {"senders", QuotedList(dds.senders)}});
  return pairs;
}

PartSettings ReadDdsOrigin(TableReader& signal) {
  DdsOrigin origin;
  signal.Text("dds", origin.channel);
  if (origin.channel.empty()) signal.Wrong("dds", "the name of a channel, e.g. \"{axis}/pressure\"");
  return PartSettings(origin);
}

std::string WriteDdsOrigin(const PartSettings& origin) { return Quoted(origin.As<DdsOrigin>()->channel); }

Delivery DdsDelivery(const Machine&, const SignalSpec&) { return {}; }

}  // namespace

const SourceKind kDdsSourceKind = {
    .name = DdsSpec::kName,
    .comment = "Samples by DDS (docs/live_protocol.md).",
    .sections = {{"live.dds", WithDdsConnectionKeys({"topic", "backlog", "deadline", "senders"})}},
    .read = ReadDdsSource,
    .write = WriteDdsSource,
    .read_origin = ReadDdsOrigin,
    .write_origin = WriteDdsOrigin,
    .delivery = DdsDelivery,
    .silent = "is the sender running, are topic, domain, interfaces and the name right?"};

std::string DdsChannelName(const Machine& machine, int signal, int axis) {
  const auto* origin = machine.signals[static_cast<std::size_t>(signal)].From<DdsOrigin>();
  return origin == nullptr ? "" : WithAxis(origin->channel, machine, axis);
}

}  // namespace hydroscope
