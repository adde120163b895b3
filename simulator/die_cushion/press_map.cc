#include "simulator/die_cushion/press_map.h"

#include <algorithm>
#include <cmath>

#include "core/constants.h"

namespace hydroscope {
namespace {

using namespace press_map;

std::span<std::uint16_t> At(std::span<std::uint16_t> registers, int first, int count) {
  return registers.subspan(static_cast<std::size_t>(first), static_cast<std::size_t>(count));
}

}  // namespace

PressMap::PressMap(int axes, double period, std::uint64_t session, WordOrder order)
    : axes_(axes), period_(period), session_(session), order_(order) {
  if (axes > kMostRingAxes) return;
  width_ = kRecordHead + kAxisValues * axes;
  records_ = std::min(kMostRecords, (kRegisters - kRing) / width_);
}

void PressMap::WriteHead(std::span<std::uint16_t> registers) const {
  registers[kVersionRegister] = kVersion;
  registers[kAxes] = static_cast<std::uint16_t>(axes_);
  EncodeUnsigned(session_ & 0xffffffff, At(registers, kSession, 2));
  EncodeUnsigned(static_cast<std::uint64_t>(std::llround(period_ * 1e6)),
                 At(registers, kPeriodMicroseconds, 2));
  registers[kRingFirst] = has_ring() ? kRing : 0;
  registers[kRingRecords] = static_cast<std::uint16_t>(records_);
  registers[kRingWidth] = static_cast<std::uint16_t>(width_);
}

void PressMap::WriteRecord(std::uint64_t sequence, const std::vector<PressRow>& rows,
                           std::span<std::uint16_t> registers) const {
  if (!has_ring()) return;
  const auto number = static_cast<std::uint32_t>(sequence);
  int place = kRing + width_ * static_cast<int>(number % static_cast<std::uint32_t>(records_));
  EncodeUnsigned(number, At(registers, place, kRecordHead));
  place += kRecordHead;
  for (const PressRow& row : rows) {
    for (const double value :
         {row.p_A, row.p_B, row.p_0, row.z, row.y_v, row.U_v, row.T_oil - kZeroCelsius}) {
      EncodeRegisters(value, RegisterType::kFloat32, order_, At(registers, place, 2));
      place += 2;
    }
  }
}

void PressMap::WriteState(std::uint64_t newest, std::int64_t time_ns, const LivePress& press,
                          const std::vector<PressRow>& rows, std::span<std::uint16_t> registers) const {
  EncodeUnsigned(newest & 0xffffffff, At(registers, kNewest, 2));
  EncodeUnsigned(static_cast<std::uint64_t>(time_ns), At(registers, kTime, 4));
  ++registers[kHeartbeat];
  registers[kSweepStatus] = static_cast<std::uint16_t>(press.sweep());
  registers[kSweepsDone] = static_cast<std::uint16_t>(press.sweeps_done());
  EncodeRegisters(rows.front().T_oil - kZeroCelsius, RegisterType::kFloat32, order_,
                  At(registers, kOilTemperature, 2));
  EncodeRegisters(rows.front().p_0 / 1e5, RegisterType::kFloat32, order_, At(registers, kSupply, 2));
  for (int axis = 0; axis < axes_; ++axis) {
    const auto words = At(registers, kAxisFirst + kAxisStride * axis, kAxisStride);
    words[0] = press.drawing() ? 1 : press.resting() ? 2 : 0;
    EncodeUnsigned(press.strokes(), words.subspan(2, 2));
  }
}

}  // namespace hydroscope
