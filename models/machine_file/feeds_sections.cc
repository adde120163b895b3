// The [feeds] part of a machine file.
#include "models/machine_file/keys.h"
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

}  // namespace hydroscope
