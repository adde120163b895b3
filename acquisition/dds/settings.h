#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "models/dds_connection.h"

namespace hydroscope {

struct Machine;

/// How the DDS samples are found; docs/live_protocol.md describes the types.
struct DdsSpec : DdsConnection {
  static constexpr std::string_view kName = "dds";

  std::string topic = "hydroscope/samples";  ///< the layout is announced on <topic>/layout
  bool backlog = false;                      ///< also the batches that the sender still holds from before
  double deadline = 0.25;                    ///< s without a batch after which the source is late
  std::vector<std::string> senders;          ///< computers that may send: addresses and networks; empty: all

  bool operator==(const DdsSpec&) const = default;
};

/// The channel that a signal comes from.
struct DdsOrigin {
  static constexpr std::string_view kName = "dds";

  std::string channel;  ///< "{axis}" stands for the axis

  bool operator==(const DdsOrigin&) const = default;
};

/// The DDS name of a signal for an axis: "{axis}" replaced; "" if it does not come by DDS.
std::string DdsChannelName(const Machine& machine, int signal, int axis);

}  // namespace hydroscope
