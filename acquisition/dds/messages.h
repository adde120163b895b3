#pragma once

#include <hydroscope_wire/hydroscope_livePubSubTypes.h>

#include <cstddef>
#include <cstdint>
#include <exception>
#include <span>
#include <type_traits>

#include "acquisition/batch_assembler.h"

namespace hydroscope {

/// Looks whether the lengths that a damaged message states can be true, before the generated code takes memory for them
/// (a length of 2^32 strings would ask for 1 TB). Offsets are those of CDR for hydroscope_live.idl.
class PayloadLengths {
 public:
  explicit PayloadLengths(std::span<const std::uint8_t> payload) : payload_(payload) {}

  bool FitBatch() { return At(kBatchValues) && Count(8); }
  bool FitLayout() { return At(kLayoutChannels) && Strings() && Strings(); }

 private:
  static constexpr std::size_t kHead = 4;  // encapsulation; alignment counts from behind it
  static constexpr std::size_t kBatchValues = kHead + 52, kLayoutChannels = kHead + 20;

  bool At(std::size_t offset) {
    at_ = offset;
    return payload_.size() >= offset;
  }
  bool Read(std::uint32_t& value) {
    at_ = (at_ + 3) / 4 * 4;
    if (at_ > payload_.size() || payload_.size() - at_ < 4) return false;
    const bool little = (payload_[1] & 1) != 0;
    value = 0;
    for (std::size_t k = 0; k < 4; ++k) value = value << 8 | payload_[at_ + (little ? 3 - k : k)];
    at_ += 4;
    return true;
  }
  /// As many elements of at least `size` bytes as stated.
  bool Count(std::size_t size) {
    std::uint32_t count = 0;
    return Read(count) && count <= (payload_.size() - at_) / size;
  }
  bool Strings() {
    std::uint32_t count = 0, length = 0;
    if (!Read(count) || count > (payload_.size() - at_) / 4) return false;
    for (; count > 0; --count) {
      if (!Read(length) || length > payload_.size() - at_) return false;
      at_ += length;
    }
    return true;
  }

  std::span<const std::uint8_t> payload_;
  std::size_t at_ = 0;
};

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
