// The [feeds] part of a machine file.
#include "models/machine_file/keys.h"
#include "models/machine_file/section_text.h"
#include "models/machine_file/sections.h"

namespace hydroscope {
namespace {

void ReadModbusFeed(TableReader& section, ModbusFeedSpec& modbus) {
  section.AllowOnly(MachineFileKeys("feeds.modbus"));
  section.Text("host", modbus.host);
  const auto host = ParseIpv4Range(modbus.host);
  if (!host || host->mask != ~std::uint32_t{0})
    section.Wrong("host", "an IPv4 address of this computer, e.g. \"127.0.0.1\"; \"0.0.0.0\" means all");
  section.Integer("port", modbus.port, 0, 65535);
  section.Integer("connections", modbus.connections, 1, 256);
  section.Number("idle_timeout", modbus.idle_timeout,
                 {.si = "s", .default_unit = "s", .low = 0, .above_low = true});
  section.Texts("allow", modbus.allow);
  CheckAddressRanges(section, "allow", modbus.allow);
  section.Flag("acknowledge", modbus.acknowledge);
}

void ReadDdsFeed(TableReader& section, DdsFeedSpec& dds) {
  section.AllowOnly(MachineFileKeys("feeds.dds"));
  section.Integer("domain", dds.domain, 0, 232);
  section.Text("topic", dds.topic);
  if (dds.topic.empty()) section.Wrong("topic", "the beginning of the topics' names, e.g. \"hydroscope\"");
  if (const auto choice = section.Choice("transport", {"default", "udp", "shm"}))
    dds.transport = static_cast<DdsTransport>(*choice);
  section.Texts("interfaces", dds.interfaces);
  section.Texts("peers", dds.peers);
  section.Text("security", dds.security);
}

void ReadSparkplugFeed(TableReader& section, SparkplugFeedSpec& sparkplug) {
  section.AllowOnly(MachineFileKeys("feeds.sparkplug"));
  section.Text("broker", sparkplug.broker);
  if (!sparkplug.broker.starts_with("tcp://") && !sparkplug.broker.starts_with("ssl://"))
    section.Wrong("broker", "tcp://HOST:PORT or ssl://HOST:PORT, e.g. \"tcp://127.0.0.1:1883\"");
  for (const auto& [key, id] : {std::pair("group", &sparkplug.group), std::pair("node", &sparkplug.node),
                                std::pair("primary_host", &sparkplug.primary_host)}) {
    section.Text(key, *id);
    if (id->find_first_of("/+#") != std::string::npos || (section.Has(key) && id->empty()))
      section.Wrong(key, "a name without /, + and #");
  }
  if (sparkplug.group.empty()) sparkplug.group = SparkplugFeedSpec{}.group;
  section.Text("user", sparkplug.user);
  section.Text("password_file", sparkplug.password_file);
  for (const auto& [key, file] :
       {std::pair("ca_file", &sparkplug.ca_file), std::pair("certificate_file", &sparkplug.certificate_file),
        std::pair("key_file", &sparkplug.key_file)}) {
    section.Text(key, *file);
    if (!file->empty() && !sparkplug.broker.starts_with("ssl://"))
      section.Wrong(key,
                    "a file only with broker = \"ssl://...\": certificates are of encrypted connections");
  }
  if (sparkplug.certificate_file.empty() != sparkplug.key_file.empty())
    section.Problem("certificate_file and key_file go together: a certificate and its private key");
}

}  // namespace

void ReadFeeds(TableReader& file, Machine& machine) {
  const toml::table* table = file.Table("feeds");
  if (table == nullptr) return;
  FeedsSpec& feeds = machine.feeds.emplace();
  TableReader section(*table, "feeds", file.problems());
  section.AllowOnly(MachineFileKeys("feeds"));
  if (const toml::table* modbus = section.Table("modbus")) {
    TableReader reader(*modbus, "feeds.modbus", file.problems());
    ReadModbusFeed(reader, feeds.modbus.emplace());
  }
  if (const toml::table* dds = section.Table("dds")) {
    TableReader reader(*dds, "feeds.dds", file.problems());
    ReadDdsFeed(reader, feeds.dds.emplace());
  }
  if (const toml::table* sparkplug = section.Table("sparkplug")) {
    TableReader reader(*sparkplug, "feeds.sparkplug", file.problems());
    ReadSparkplugFeed(reader, feeds.sparkplug.emplace());
  }
}

std::string FeedsSections(const Machine& machine, const MachineNotes& notes) {
  if (!machine.feeds) return "";
  std::string text = Section("[feeds]", "Whom the live service tells.", {}, notes, "feeds");
  if (const auto& modbus = machine.feeds->modbus)
    text += Section("[feeds.modbus]", "Modbus TCP server (docs/register_map.md).",
                    {{"host", Quoted(modbus->host)},
                     {"port", Plain(modbus->port)},
                     {"connections", Plain(modbus->connections)},
                     {"idle_timeout", Plain(modbus->idle_timeout)},
                     {"allow", QuotedList(modbus->allow)},
                     {"acknowledge", Plain(modbus->acknowledge)}},
                    notes, "feeds.modbus");
  if (const auto& dds = machine.feeds->dds)
    text += Section("[feeds.dds]", "Alarm events and findings by DDS (docs/live_protocol.md).",
                    {{"domain", Plain(dds->domain)},
                     {"topic", Quoted(dds->topic)},
                     {"transport", TransportName(dds->transport)},
                     {"interfaces", QuotedList(dds->interfaces)},
                     {"peers", QuotedList(dds->peers)},
                     {"security", Quoted(dds->security)}},
                    notes, "feeds.dds");
  if (const auto& sparkplug = machine.feeds->sparkplug) {
    Pairs pairs = {{"broker", Quoted(sparkplug->broker)}, {"group", Quoted(sparkplug->group)}};
    const std::pair<const char*, const std::string*> optional[] = {
        {"node", &sparkplug->node},
        {"user", &sparkplug->user},
        {"password_file", &sparkplug->password_file},
        {"primary_host", &sparkplug->primary_host},
        {"ca_file", &sparkplug->ca_file},
        {"certificate_file", &sparkplug->certificate_file},
        {"key_file", &sparkplug->key_file}};
    for (const auto& [key, value] : optional)
      if (!value->empty()) pairs.emplace_back(key, Quoted(*value));
    text += Section("[feeds.sparkplug]", "MQTT Sparkplug B edge node (docs/sparkplug.md).", pairs, notes,
                    "feeds.sparkplug");
  }
  return text;
}

}  // namespace hydroscope
