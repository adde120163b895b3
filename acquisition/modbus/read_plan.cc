#include "acquisition/modbus/read_plan.h"

#include <algorithm>
#include <limits>

namespace hydroscope {
namespace {

constexpr int kGapReadAlong = 20;  // registers; another request costs more
constexpr int kSequenceRegisters = 2;

enum class Meaning { kValue, kHeartbeat, kTime };
struct Item {
  int first = 0, count = 0;
  Meaning meaning = Meaning::kValue;
  PlannedValue value;
};

std::vector<Item> ItemsOf(const Machine& machine, bool ring) {
  std::vector<Item> items;
  const ModbusSpec& modbus = *machine.Source<ModbusSpec>();
  const auto signals = static_cast<int>(machine.signals.size());
  for (const LiveChannel& channel : LiveChannels(machine)) {
    const auto* origin = machine.signals[static_cast<std::size_t>(channel.signal)].From<ModbusOrigin>();
    if (origin == nullptr || origin->in_ring != ring) continue;
    const int first = origin->address + origin->stride * channel.axis;
    const auto index = static_cast<std::uint16_t>(channel.axis * signals + channel.signal);
    items.push_back({first,
                     RegisterCount(origin->type),
                     Meaning::kValue,
                     {0, origin->type, origin->order.value_or(modbus.order), index}});
  }
  return items;
}

void Add(const Item& item, ReadBlock& block) {
  const int offset = item.first - block.first;
  if (item.meaning == Meaning::kHeartbeat) block.heartbeat = offset;
  if (item.meaning == Meaning::kTime) block.time = offset;
  if (item.meaning != Meaning::kValue) return;
  block.values.push_back(item.value);
  block.values.back().offset = offset;
}

}  // namespace

std::vector<ReadBlock> PlanReads(const Machine& machine) {
  const auto* modbus = machine.Source<ModbusSpec>();
  if (modbus == nullptr) return {};
  std::vector<Item> items = ItemsOf(machine, false);
  if (items.empty()) return {};
  if (modbus->heartbeat) items.push_back({*modbus->heartbeat, 1, Meaning::kHeartbeat, {}});
  if (modbus->time) items.push_back({*modbus->time, 4, Meaning::kTime, {}});
  std::stable_sort(items.begin(), items.end(),
                   [](const Item& a, const Item& b) { return a.first < b.first; });
  std::vector<ReadBlock> blocks;
  for (const Item& item : items) {
    const int end = item.first + item.count;
    ReadBlock* block = blocks.empty() ? nullptr : &blocks.back();
    if (block == nullptr || item.first - (block->first + block->count) > kGapReadAlong ||
        end - block->first > kMostRegisters) {
      blocks.push_back({.first = item.first, .count = 0, .values = {}, .heartbeat = {}, .time = {}});
      block = &blocks.back();
    }
    block->count = std::max(block->count, end - block->first);
    Add(item, *block);
  }
  return blocks;
}

std::vector<PlannedValue> PlanRing(const Machine& machine) {
  std::vector<PlannedValue> values;
  const auto* modbus = machine.Source<ModbusSpec>();
  if (modbus == nullptr || !modbus->ring) return values;
  for (const Item& item : ItemsOf(machine, true)) {
    values.push_back(item.value);
    values.back().offset = kSequenceRegisters + item.first;
  }
  return values;
}

SampleBatch DecodeBlock(const ReadBlock& block, std::span<const std::uint16_t> registers) {
  SampleBatch batch;
  batch.rows = 1;
  for (const PlannedValue& value : block.values) {
    const auto offset = static_cast<std::size_t>(value.offset);
    batch.channels.push_back(value.channel);
    batch.values.push_back(offset < registers.size()
                               ? DecodeRegisters(registers.subspan(offset), value.type, value.order)
                               : std::numeric_limits<double>::quiet_NaN());
  }
  if (block.time && registers.size() >= static_cast<std::size_t>(*block.time) + 4)
    batch.source_time_ns = static_cast<std::int64_t>(
        DecodeUnsigned(registers.subspan(static_cast<std::size_t>(*block.time), 4)));
  return batch;
}

}  // namespace hydroscope
