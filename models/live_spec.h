#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/registers.h"

namespace hydroscope {

struct Machine;

/// Where a signal stands in the registers of a controller.
struct ModbusOrigin {
  bool in_ring = false;  ///< true: `address` counts from the registers behind a ring record's sequence number
  int address = 0;       ///< 0-based register of the first axis
  int stride = 0;        ///< registers from one axis to the next; 0: one value for all axes
  RegisterType type = RegisterType::kFloat32;
  std::optional<WordOrder> order;  ///< of [live.modbus] if absent

  bool operator==(const ModbusOrigin&) const = default;
};

enum class DdsTransport { kDefault, kUdp, kSharedMemory };

/// How the DDS samples are found; docs/live_protocol.md describes the types.
struct DdsSpec {
  int domain = 0;
  std::string topic = "hydroscope/samples";         ///< the layout is announced on <topic>/layout
  DdsTransport transport = DdsTransport::kDefault;  ///< shared memory where possible, else UDP
  std::vector<std::string> interfaces;              ///< addresses of the network cards used; empty: all
  std::vector<std::string> peers;    ///< addresses asked where the network carries no multicast
  bool backlog = false;              ///< also the batches that the sender still holds from before
  double deadline = 0.25;            ///< s without a batch after which the source is late
  std::vector<std::string> senders;  ///< computers that may send: addresses and networks; empty: all
  std::string security;              ///< folder of the certificates of DDS Security; "": without

  bool operator==(const DdsSpec&) const = default;
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
  int status =
      0;  ///< uint16: 0 idle, 1 granted, 2 running, 3 done, 4 refused because busy, 5 refused, 6 broken off
  int axis = 0;       ///< uint16, written before the coil: 1 = first axis
  int amplitude = 0;  ///< uint16, written before the coil: 1/10000 of full scale

  bool operator==(const ModbusSweepSpec&) const = default;
};

struct ModbusSpec {
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

/// The [live] part of a machine file: one press with axes of the same physics.
struct LiveSpec {
  double grid_period = 1e-3;      ///< s, grid onto which all channels are aligned
  std::vector<std::string> axes;  ///< "cushion_1", ...; empty: the machine is its only axis
  std::optional<DdsSpec> dds;
  std::optional<ModbusSpec> modbus;

  bool operator==(const LiveSpec&) const = default;
};

/// One channel of a live machine: a signal of an axis. A signal that all axes share is a channel of every axis.
struct LiveChannel {
  std::string name;  ///< "cushion_1/p_A"; "p_A" if the machine has no named axes
  int axis = 0;      ///< index in LiveSpec::axes
  int signal = 0;    ///< index in Machine::signals
};

/// Whether the machine is a press whose axes have names.
bool HasNamedAxes(const Machine& machine);
/// Number of axes, at least 1.
int AxisCount(const Machine& machine);
/// "press/cushion_1"; the machine's name if it has no named axes.
std::string AxisMachineName(const Machine& machine, int axis);
/// The machine as the database has one axis of it: under the axis's name, and with columns of its own in a
/// log of all axes ("{axis}" replaced). The machine itself if it has no named axes.
Machine MachineOfAxis(const Machine& machine, int axis);
/// One for each axis.
std::vector<Machine> MachinesOfAxes(const Machine& machine);
/// Whether a log holds all axes side by side: columns have "{axis}" in their names.
bool LogHoldsAllAxes(const Machine& machine);
/// All channels; the one of a signal of an axis has the index axis * signals + signal. Signals without a live
/// origin have a channel that stays silent.
std::vector<LiveChannel> LiveChannels(const Machine& machine);
/// The DDS name of a signal for an axis: "{axis}" replaced.
std::string DdsChannelName(const Machine& machine, int signal, int axis);

}  // namespace hydroscope
