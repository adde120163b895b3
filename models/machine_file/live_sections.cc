// The [live] part of a machine file, and where each signal comes from.
#include <algorithm>
#include <set>

#include "models/ipv4_range.h"
#include "models/machine_file/keys.h"
#include "models/machine_file/section_text.h"
#include "models/machine_file/sections.h"

namespace hydroscope {

void CheckAddressRanges(TableReader& section, const char* key, const std::vector<std::string>& ranges) {
  for (const std::string& range : ranges)
    if (!ParseIpv4Range(range))
      section.Wrong(key, fmt::format("addresses and networks such as \"192.168.0.7\" and "
                                     "\"192.168.0.0/24\"; \"{}\" is neither",
                                     range));
}

namespace {

constexpr int kLastRegister = 65535;
constexpr int kReadableRegisters = 125;  // in one request, by the Modbus specification
std::vector<std::string> Names(const auto& names) { return {names.begin(), names.end()}; }

void ReadOrder(TableReader& reader, WordOrder& order) {
  if (const auto choice = reader.Choice("order", Names(kWordOrderNames)))
    order = static_cast<WordOrder>(*choice);
}

void ReadAxes(TableReader& section, std::vector<std::string>& axes) {
  section.Texts("axes", axes);
  const std::set<std::string> once(axes.begin(), axes.end());
  if (once.size() != axes.size()) section.Wrong("axes", "every axis only once");
  for (const std::string& axis : axes)
    if (axis.empty() || axis.find_first_of("/{}\n") != std::string::npos)
      section.Wrong("axes", "names without /, { and }, e.g. [\"cushion_1\", \"cushion_2\"]");
}

void ReadDds(TableReader& section, DdsSpec& dds) {
  section.AllowOnly(MachineFileKeys("live.dds"));
  section.Integer("domain", dds.domain, 0, 232);
  section.Text("topic", dds.topic);
  if (dds.topic.empty()) section.Wrong("topic", "the name of a topic, e.g. \"hydroscope/samples\"");
  if (const auto choice = section.Choice("transport", {"default", "udp", "shm"}))
    dds.transport = static_cast<DdsTransport>(*choice);
  section.Texts("interfaces", dds.interfaces);
  section.Texts("peers", dds.peers);
  section.Flag("backlog", dds.backlog);
  section.Number("deadline", dds.deadline, kSecondsAboveZero);
  section.Texts("senders", dds.senders);
  CheckAddressRanges(section, "senders", dds.senders);
  section.Text("security", dds.security);
}

void ReadRing(TableReader& section, ModbusRingSpec& ring) {
  section.AllowOnly(MachineFileKeys("live.modbus.ring"));
  section.Integer("session", ring.session, 0, kLastRegister - 1);
  section.Integer("newest", ring.newest, 0, kLastRegister - 1);
  section.Integer("time", ring.time, 0, kLastRegister - 3);
  section.Integer("first", ring.first, 0, kLastRegister);
  section.Integer("records", ring.records, 2, kLastRegister);
  section.Integer("width", ring.width, 3, kReadableRegisters);
  section.Number("period", ring.period,
                 {.si = "s", .default_unit = "s", .low = 0, .high = 60, .above_low = true});
  section.Number("poll_period", ring.poll_period, kSecondsAboveZero);
  if (static_cast<std::int64_t>(ring.records) * ring.width > kLastRegister + 1 - ring.first)
    section.Wrong("records", "a ring that ends before register 65536");
  if (ring.records * ring.period < 2 * ring.poll_period)
    section.Wrong("poll_period",
                  fmt::format("at most half of the {} s that the ring holds, else samples are lost",
                              ring.records * ring.period));
}

void ReadSweep(TableReader& section, ModbusSweepSpec& sweep) {
  section.AllowOnly(MachineFileKeys("live.modbus.sweep"));
  for (const auto& [key, number] :
       {std::pair("coil", &sweep.coil), std::pair("status", &sweep.status), std::pair("axis", &sweep.axis),
        std::pair("amplitude", &sweep.amplitude)}) {
    section.Integer(key, *number, 0, kLastRegister);
    if (!section.Has(key)) section.Problem(fmt::format("{} is missing; write e.g. {} = 20", key, key));
  }
}

void ReadModbus(TableReader& section, ModbusSpec& modbus) {
  section.AllowOnly(MachineFileKeys("live.modbus"));
  section.Text("host", modbus.host);
  if (modbus.host.empty()) section.Wrong("host", "an address or a name, e.g. \"192.168.0.10\"");
  section.Integer("port", modbus.port, 1, 65535);
  section.Integer("unit", modbus.unit, 0, 255);
  ReadOrder(section, modbus.order);
  section.Number("poll_period", modbus.poll_period, kSecondsAboveZero);
  section.Number("timeout", modbus.timeout, kSecondsAboveZero);
  section.Number("retry_first", modbus.retry_first, kSecondsAboveZero);
  section.Number("retry_limit", modbus.retry_limit, kSecondsAboveZero);
  if (modbus.retry_limit < modbus.retry_first)
    section.Wrong("retry_limit", "a time not shorter than retry_first");
  section.Integer("heartbeat", modbus.heartbeat, 0, kLastRegister);
  section.Integer("time", modbus.time, 0, kLastRegister - 3);
  if (const toml::table* table = section.Table("ring")) {
    TableReader ring(*table, "live.modbus.ring", section.problems());
    ReadRing(ring, modbus.ring.emplace());
  }
  if (const toml::table* table = section.Table("sweep")) {
    TableReader sweep(*table, "live.modbus.sweep", section.problems());
    ReadSweep(sweep, modbus.sweep.emplace());
  }
}

void ReadModbusOrigin(TableReader& reader, ModbusOrigin& origin) {
  reader.AllowOnly(MachineFileKeys("signals.<name>.modbus"));
  if (reader.Has("register") == reader.Has("ring"))
    reader.Problem("expected either register = <number> or ring = <place in the record>");
  origin.in_ring = reader.Has("ring");
  reader.Integer(origin.in_ring ? "ring" : "register", origin.address, 0, kLastRegister);
  reader.Integer("stride", origin.stride, 0, kLastRegister);
  if (const auto type = reader.Choice("type", Names(kRegisterTypeNames)))
    origin.type = static_cast<RegisterType>(*type);
  if (reader.Has("order")) ReadOrder(reader, origin.order.emplace(WordOrder::kAbcd));
}

/// The last register of the last axis must exist.
void CheckRegisters(TableReader& file, const Machine& machine, const SignalSpec& signal) {
  const ModbusOrigin& origin = *signal.modbus;
  const auto& ring = machine.live->modbus->ring;
  if (origin.in_ring && !ring) {
    file.Problem(fmt::format("[signals.{}] modbus: there is no ring; add ring = {{ ... }} to [live.modbus]",
                             signal.name));
    return;
  }
  const std::int64_t last = origin.address +
                            static_cast<std::int64_t>(origin.stride) * (AxisCount(machine) - 1) +
                            RegisterCount(origin.type) - 1;
  const int limit = origin.in_ring ? ring->width - 3 : kLastRegister;  // the sequence number takes two
  if (last > limit)
    file.Problem(fmt::format("[signals.{}] modbus: the last axis ends in {} {}; the last one is {}",
                             signal.name, origin.in_ring ? "place" : "register", last, limit));
}

}  // namespace

void ReadSignalOrigin(TableReader& signal, const toml::table& table, SignalSpec& spec) {
  signal.Text("dds", spec.dds);
  if (table.contains("dds") && spec.dds.empty())
    signal.Wrong("dds", "the name of a channel, e.g. \"{axis}/p_A\"");
  if (const toml::table* modbus = signal.Table("modbus")) {
    TableReader reader(*modbus, signal.path() + ".modbus", signal.problems());
    ReadModbusOrigin(reader, spec.modbus.emplace());
  }
}

void ReadLive(TableReader& file, Machine& machine) {
  const toml::table* table = file.Table("live");
  if (table == nullptr) return;
  LiveSpec& live = machine.live.emplace();
  TableReader section(*table, "live", file.problems());
  section.AllowOnly(MachineFileKeys("live"));
  section.Number("grid_period", live.grid_period, kSecondsAboveZero);
  ReadAxes(section, live.axes);
  if (const toml::table* dds = section.Table("dds")) {
    TableReader reader(*dds, "live.dds", file.problems());
    ReadDds(reader, live.dds.emplace());
  }
  if (const toml::table* modbus = section.Table("modbus")) {
    TableReader reader(*modbus, "live.modbus", file.problems());
    ReadModbus(reader, live.modbus.emplace());
  }
}

void CheckLive(TableReader& file, const Machine& machine) {
  const bool dds = machine.live && machine.live->dds;
  const bool modbus = machine.live && machine.live->modbus;
  for (const SignalSpec& signal : machine.signals) {
    if (!signal.dds.empty() && signal.modbus)
      file.Problem(
          fmt::format("[signals.{}] has both dds and modbus; a signal comes from one place", signal.name));
    if (!signal.dds.empty() && !dds)
      file.Problem(fmt::format("[signals.{}] dds needs a section [live.dds]", signal.name));
    if (signal.modbus && !modbus)
      file.Problem(fmt::format("[signals.{}] modbus needs a section [live.modbus]", signal.name));
    if (signal.modbus && modbus) CheckRegisters(file, machine, signal);
    if (machine.live && signal.required && signal.dds.empty() && !signal.modbus)
      file.Problem(
          fmt::format("[signals.{}] has neither dds nor modbus, but the machine is [live]; say where it "
                      "comes from, or required = false",
                      signal.name));
  }
}

std::string TransportName(DdsTransport transport) {
  const char* const transports[] = {"default", "udp", "shm"};
  return Quoted(transports[static_cast<int>(transport)]);
}

namespace {

std::string RingValue(const ModbusRingSpec& ring) {
  Pairs pairs = {{"session", Plain(ring.session)}, {"newest", Plain(ring.newest)}};
  if (ring.time) pairs.emplace_back("time", Plain(*ring.time));
  for (const auto& [key, number] :
       {std::pair("first", ring.first), std::pair("records", ring.records), std::pair("width", ring.width)})
    pairs.emplace_back(key, Plain(number));
  pairs.emplace_back("period", Plain(ring.period));
  pairs.emplace_back("poll_period", Plain(ring.poll_period));
  return Inline(pairs);
}

std::string LiveModbusSection(const ModbusSpec& modbus, const MachineNotes& notes) {
  Pairs pairs = {{"host", Quoted(modbus.host)},
                 {"port", Plain(modbus.port)},
                 {"unit", Plain(modbus.unit)},
                 {"order", OrderName(modbus.order)},
                 {"poll_period", Plain(modbus.poll_period)},
                 {"timeout", Plain(modbus.timeout)},
                 {"retry_first", Plain(modbus.retry_first)},
                 {"retry_limit", Plain(modbus.retry_limit)}};
  if (modbus.heartbeat) pairs.emplace_back("heartbeat", Plain(*modbus.heartbeat));
  if (modbus.time) pairs.emplace_back("time", Plain(*modbus.time));
  if (modbus.ring) pairs.emplace_back("ring", RingValue(*modbus.ring));
  if (const auto& sweep = modbus.sweep)
    pairs.emplace_back("sweep", Inline({{"coil", Plain(sweep->coil)},
                                        {"status", Plain(sweep->status)},
                                        {"axis", Plain(sweep->axis)},
                                        {"amplitude", Plain(sweep->amplitude)}}));
  return Section("[live.modbus]", "Registers of the controller; times in s.", pairs, notes, "live.modbus");
}

std::string LiveDdsSection(const DdsSpec& dds, const MachineNotes& notes) {
  return Section("[live.dds]", "Samples by DDS (docs/live_protocol.md).",
                 {{"domain", Plain(dds.domain)},
                  {"topic", Quoted(dds.topic)},
                  {"transport", TransportName(dds.transport)},
                  {"interfaces", QuotedList(dds.interfaces)},
                  {"peers", QuotedList(dds.peers)},
                  {"backlog", Plain(dds.backlog)},
                  {"deadline", Plain(dds.deadline)},
                  {"senders", QuotedList(dds.senders)},
                  {"security", Quoted(dds.security)}},
                 notes, "live.dds");
}

}  // namespace

std::string LiveSections(const Machine& machine, const MachineNotes& notes) {
  if (!machine.live) return "";
  const LiveSpec& live = *machine.live;
  std::string text =
      Section("[live]", "The machine as it is watched live.",
              {{"grid_period", Plain(live.grid_period)}, {"axes", QuotedList(live.axes)}}, notes, "live");
  if (live.dds) text += LiveDdsSection(*live.dds, notes);
  if (live.modbus) text += LiveModbusSection(*live.modbus, notes);
  return text;
}

}  // namespace hydroscope
