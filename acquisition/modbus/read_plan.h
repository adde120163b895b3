#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "acquisition/modbus/settings.h"
#include "acquisition/source.h"
#include "core/registers.h"
#include "models/machine.h"

namespace hydroscope {

/// Most registers that one request reads (Modbus Application Protocol V1.1b3, 6.3).
inline constexpr int kMostRegisters = 125;

/// A value within a block of registers.
struct PlannedValue {
  int offset = 0;  ///< registers behind the first one of the block
  RegisterType type = RegisterType::kFloat32;
  WordOrder order = WordOrder::kAbcd;
  std::uint16_t channel = 0;
};

/// Registers that one request reads.
struct ReadBlock {
  int first = 0, count = 0;
  std::vector<PlannedValue> values;
  std::optional<int> heartbeat, time;  ///< offsets, if they are in this block
};

/// The polled registers of a machine in as few requests as possible: what lies at most 20 registers apart is
/// read together, 125 registers at most.
std::vector<ReadBlock> PlanReads(const Machine& machine);

/// The values of the ring's records, with offsets from the beginning of a record.
std::vector<PlannedValue> PlanRing(const Machine& machine);

/// One row of the block's channels from what was read; nothing is missing if `registers` has the block's
/// size, else the values that lie beyond are NaN.
SampleBatch DecodeBlock(const ReadBlock& block, std::span<const std::uint16_t> registers);

}  // namespace hydroscope
