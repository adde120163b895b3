#include "acquisition/modbus/settings.h"

#include <fmt/format.h>

#include "acquisition/list.h"
#include "models/machine_file/sections.h"

namespace hydroscope {
namespace {

constexpr int kLastRegister = 65535;
constexpr int kReadableRegisters = 125;  // in one request, by the Modbus specification
std::vector<std::string> Names(const auto& names) { return {names.begin(), names.end()}; }

std::string OrderName(WordOrder order) {
  return Quoted(std::string(kWordOrderNames[static_cast<std::size_t>(order)]));
}

void ReadOrder(TableReader& reader, WordOrder& order) {
  if (const auto choice = reader.Choice("order", Names(kWordOrderNames)))
    order = static_cast<WordOrder>(*choice);
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

PartSettings ReadModbusSource(TableReader& section) {
  ModbusSpec modbus;
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
  return PartSettings(modbus);
}

PartSettings ReadModbusOrigin(TableReader& signal) {
  ModbusOrigin origin;
  const toml::table* table = signal.Table("modbus");
  if (table == nullptr) return PartSettings(origin);
  TableReader reader(*table, signal.path() + ".modbus", signal.problems());
  reader.AllowOnly(MachineFileKeys("signals.<name>.modbus"));
  if (reader.Has("register") == reader.Has("ring"))
    reader.Problem("expected either register = <number> or ring = <place in the record>");
  origin.in_ring = reader.Has("ring");
  reader.Integer(origin.in_ring ? "ring" : "register", origin.address, 0, kLastRegister);
  reader.Integer("stride", origin.stride, 0, kLastRegister);
  if (const auto type = reader.Choice("type", Names(kRegisterTypeNames)))
    origin.type = static_cast<RegisterType>(*type);
  if (reader.Has("order")) ReadOrder(reader, origin.order.emplace(WordOrder::kAbcd));
  return PartSettings(origin);
}

/// The last register of the last axis must exist.
void CheckRegisters(TableReader& file, const Machine& machine, const SignalSpec& signal) {
  const ModbusOrigin& origin = *signal.From<ModbusOrigin>();
  const auto& ring = machine.live->sources.Of<ModbusSpec>()->ring;
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

/// Whether a register of `a` at one axis is one of `b` at the same or another.
bool RegistersOverlap(const Machine& machine, const SignalSpec& a, const SignalSpec& b) {
  const ModbusOrigin &one = *a.From<ModbusOrigin>(), &other = *b.From<ModbusOrigin>();
  if (one.in_ring != other.in_ring) return false;
  const std::int64_t axes = AxisCount(machine);
  for (std::int64_t i = 0; i < axes; ++i)
    for (std::int64_t j = 0; j < axes; ++j) {
      const std::int64_t first = one.address + i * one.stride, second = other.address + j * other.stride;
      if (first < second + RegisterCount(other.type) && second < first + RegisterCount(one.type)) return true;
    }
  return false;
}

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

Pairs WriteModbusSource(const PartSettings& settings) {
  const ModbusSpec& modbus = *settings.As<ModbusSpec>();
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
  return pairs;
}

std::string WriteModbusOrigin(const PartSettings& place) {
  const ModbusOrigin& origin = *place.As<ModbusOrigin>();
  Pairs pairs = {{origin.in_ring ? "ring" : "register", Plain(origin.address)}};
  if (origin.stride != 0) pairs.emplace_back("stride", Plain(origin.stride));
  pairs.emplace_back("type", Quoted(std::string(kRegisterTypeNames[static_cast<std::size_t>(origin.type)])));
  if (origin.order) pairs.emplace_back("order", OrderName(*origin.order));
  return Inline(pairs);
}

Delivery ModbusDelivery(const Machine& machine, const SignalSpec& signal) {
  if (signal.From<ModbusOrigin>()->in_ring) return {};
  return {.streamed = false, .period = machine.live->sources.Of<ModbusSpec>()->poll_period};
}

}  // namespace

const SourceKind kModbusSourceKind = {
    .name = ModbusSpec::kName,
    .comment = "Registers of the controller; times in s.",
    .sections = {{"live.modbus",
                  {"host", "port", "unit", "order", "poll_period", "timeout", "retry_first", "retry_limit",
                   "heartbeat", "time", "ring", "sweep"}},
                 {"live.modbus.ring",
                  {"session", "newest", "time", "first", "records", "width", "period", "poll_period"}},
                 {"live.modbus.sweep", {"coil", "status", "axis", "amplitude"}},
                 {"signals.<name>.modbus", {"register", "ring", "stride", "type", "order"}}},
    .read = ReadModbusSource,
    .write = WriteModbusSource,
    .read_origin = ReadModbusOrigin,
    .write_origin = WriteModbusOrigin,
    .check = CheckRegisters,
    .overlap = RegistersOverlap,
    .delivery = ModbusDelivery,
    .silent = "are host, port, unit and register right?"};

}  // namespace hydroscope
