#pragma once

#include <hydroscope_wire/hydroscope_livePubSubTypes.h>

#include <exception>
#include <type_traits>

#include "acquisition/batch_assembler.h"
#include "acquisition/dds/payload_lengths.h"

namespace hydroscope {

/// A generated type whose reading of bytes from outside throws nothing: the generated code lets some
/// exceptions of damaged messages (a wrong encapsulation, a length without memory) escape, and they would end the process.
template <typename Generated>
class Tolerant : public Generated {
 public:
  bool deserialize(eprosima::fastrtps::rtps::SerializedPayload_t* payload, void* data) override {
    PayloadLengths lengths({payload->data, payload->length});
    if constexpr (std::is_same_v<typename Generated::type, hydroscope_wire::Layout>) {
      if (!lengths.FitLayout()) return false;
    } else {
      if (!lengths.FitBatch()) return false;
    }
    try {
      return Generated::deserialize(payload, data);
    } catch (const std::exception&) {
      return false;
    }
  }
};

/// Messages of the wire as plain records.
inline LayoutMessage ToMessage(const hydroscope_wire::Layout& wire) {
  LayoutMessage message{.version = wire.version(),
                        .session = wire.session(),
                        .layout_id = wire.layout_id(),
                        .channels = {},
                        .writer = 0};
  for (const auto& name : wire.channels()) message.channels.emplace_back(name.c_str());
  return message;
}

inline BatchMessage ToMessage(hydroscope_wire::Batch&& wire) {
  return {.version = wire.version(),
          .session = wire.session(),
          .layout_id = wire.layout_id(),
          .first_sequence = wire.first_sequence(),
          .source_time_ns = wire.source_time_ns(),
          .period_ns = wire.period_ns(),
          .rows = wire.rows(),
          .values = std::move(wire.values()),
          .writer = 0};
}

}  // namespace hydroscope
