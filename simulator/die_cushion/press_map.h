#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/registers.h"
#include "simulator/die_cushion/live_press.h"

namespace hydroscope {

/// The register map of the simulated press, version 1 (docs/live_protocol.md). Holding registers, counted
/// from 0; whole numbers most significant word first, floats in the word order of the map.
namespace press_map {
inline constexpr std::uint16_t kVersion = 1;
inline constexpr int kVersionRegister = 0, kAxes = 1, kSession = 2, kNewest = 4, kPeriodMicroseconds = 6,
                     kTime = 8, kRingFirst = 12, kRingRecords = 13, kRingWidth = 14, kHeartbeat = 15;
inline constexpr int kSweepStatus = 20, kSweepAxis = 21, kSweepAmplitude = 22, kSweepsDone = 23;
inline constexpr int kOilTemperature = 30, kSupply = 32;
inline constexpr int kAxisFirst = 40, kAxisStride = 4;  ///< state (uint16), 0, strokes (uint32)
inline constexpr int kRing = 1000;                      ///< first register of the ring
inline constexpr int kRegisters = 65536;
inline constexpr int kSweepCoil = 0, kCoils = 8;
/// A record: sequence number (uint32), then p_A, p_B, p_0 (Pa), z (m), y_v (1), U_v (V), T_oil (degC) of each axis.
inline constexpr int kRecordHead = 2, kAxisValues = 14, kMostRingAxes = 8, kMostRecords = 1024;
}  // namespace press_map

/// Writes what the press shows into its registers.
class PressMap {
 public:
  /// `session` is another one in every life.
  PressMap(int axes, double period, std::uint64_t session, WordOrder order);

  bool has_ring() const { return records_ > 0; }
  int ring_records() const { return records_; }
  int ring_width() const { return width_; }

  /// What never changes.
  void WriteHead(std::span<std::uint16_t> registers) const;
  /// One row into the ring, `sequence` being its number; the newest sequence is told by WriteState.
  void WriteRecord(std::uint64_t sequence, const std::vector<PressRow>& rows,
                   std::span<std::uint16_t> registers) const;
  /// The present state after row `newest`, which the sender's clock shows as `time_ns`.
  void WriteState(std::uint64_t newest, std::int64_t time_ns, const LivePress& press,
                  const std::vector<PressRow>& rows, std::span<std::uint16_t> registers) const;

 private:
  int axes_;
  double period_;
  std::uint64_t session_;
  WordOrder order_;
  int width_ = 0, records_ = 0;
};

}  // namespace hydroscope
