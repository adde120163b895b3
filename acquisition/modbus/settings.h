#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "core/registers.h"

namespace hydroscope {

/// Where a signal stands in the registers of a controller.
struct ModbusOrigin {
  static constexpr std::string_view kName = "modbus";

  bool in_ring = false;  ///< true: `address` counts from the registers behind a ring record's sequence number
  int address = 0;       ///< 0-based register of the first axis
  int stride = 0;        ///< registers from one axis to the next; 0: one value for all axes
  RegisterType type = RegisterType::kFloat32;
  std::optional<WordOrder> order;  ///< of [live.modbus] if absent

  bool operator==(const ModbusOrigin&) const = default;
};

/// A ring of the newest samples: `records` records of `width` registers from `first` on. A record is its
/// sequence number (uint32) followed by the values; sequence s lies in record s modulo `records`. Single
/// numbers below are registers; uint32 and int64 with the most significant word first.
struct ModbusRingSpec {
  int session = 0;          ///< uint32, another one for every life of the sender
  int newest = 2;           ///< uint32, sequence of the newest complete record
  std::optional<int> time;  ///< int64, the sender's clock at the newest record, ns since 1970
  int first = 1000;
  int records = 512;
  int width = 16;
  double period = 1e-3;       ///< s between records
  double poll_period = 0.02;  ///< s

  bool operator==(const ModbusRingSpec&) const = default;
};

/// How a valve sweep is asked for. The controller alone decides.
struct ModbusSweepSpec {
  int coil = 0;  ///< written 1 to ask
  /// uint16: 0 idle, 1 granted, 2 running, 3 done, 4 refused because busy, 5 refused, 6 broken off.
  int status = 0;
  int axis = 0;       ///< uint16, written before the coil: 1 = first axis
  int amplitude = 0;  ///< uint16, written before the coil: 1/10000 of full scale

  bool operator==(const ModbusSweepSpec&) const = default;
};

/// The registers of a controller.
struct ModbusSpec {
  static constexpr std::string_view kName = "modbus";

  std::string host = "127.0.0.1";
  int port = 502;
  int unit = 1;
  WordOrder order = WordOrder::kAbcd;
  double poll_period = 0.1;      ///< s between two readings of a register
  double timeout = 0.3;          ///< s for an answer
  double retry_first = 0.1;      ///< s before the first attempt to connect again; doubles each time ...
  double retry_limit = 2.0;      ///< s ... up to this
  std::optional<int> heartbeat;  ///< register that changes while the controller lives
  std::optional<int> time;       ///< int64, the controller's clock, ns since 1970
  std::optional<ModbusRingSpec> ring;
  std::optional<ModbusSweepSpec> sweep;

  bool operator==(const ModbusSpec&) const = default;
};

}  // namespace hydroscope
