#include "alarms/feeds/modbus/settings.h"

#include "alarms/feeds/list.h"
#include "models/ipv4_range.h"
#include "models/machine_file/sections.h"

namespace hydroscope {
namespace {

PartSettings ReadModbusSettings(TableReader& section) {
  ModbusFeedSpec modbus;
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
  return PartSettings(modbus);
}

Pairs WriteModbusSettings(const PartSettings& settings) {
  const ModbusFeedSpec& modbus = *settings.As<ModbusFeedSpec>();
  return {{"host", Quoted(modbus.host)},
          {"port", Plain(modbus.port)},
          {"connections", Plain(modbus.connections)},
          {"idle_timeout", Plain(modbus.idle_timeout)},
          {"allow", QuotedList(modbus.allow)},
          {"acknowledge", Plain(modbus.acknowledge)}};
}

}  // namespace

const FeedSection kModbusFeedSection = {
    .name = ModbusFeedSpec::kName,
    .comment = "Modbus TCP server (docs/register_map.md).",
    .keys = {"host", "port", "connections", "idle_timeout", "allow", "acknowledge"},
    .read = ReadModbusSettings,
    .write = WriteModbusSettings};

}  // namespace hydroscope
