#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

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

}  // namespace hydroscope
