// libFuzzer target: whatever bytes arrive as a DDS message, they become a batch that keeps to its own sizes,
// or are counted as malformed. The first byte chooses the type.
#include <cstdlib>

#include "acquisition/batch_assembler.h"
#include "acquisition/dds/messages.h"

namespace {

using namespace hydroscope;

/// Deserialises as the library does on reception.
template <typename Type, typename Message>
bool Read(const std::uint8_t* data, std::size_t size, Message& message) {
  eprosima::fastrtps::rtps::SerializedPayload_t payload(static_cast<std::uint32_t>(size));
  std::copy(data, data + size, payload.data);
  payload.length = static_cast<std::uint32_t>(size);
  return Type().deserialize(&payload, &message);
}

void Check(const SampleBatch& batch) {
  if (batch.rows == 0 || batch.values.size() != batch.rows * batch.channels.size()) std::abort();
  for (const std::uint16_t channel : batch.channels)
    if (channel > 1) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  // A known layout first, so that a batch of session 0, layout 0 is taken; messages are cut at 64-byte marks.
  BatchAssembler assembler({"p", "z"});
  assembler.Receive(LayoutMessage{kLiveProtocolVersion, 0, 0, {"p", "z"}}, Check);
  while (size > 1) {
    const std::size_t length = std::min<std::size_t>(size - 1, 64 + 4 * data[0]);
    if (data[0] % 4 == 0) {
      hydroscope_wire::Layout layout;
      if (Read<Tolerant<hydroscope_wire::LayoutPubSubType>>(data + 1, length, layout))
        assembler.Receive(ToMessage(layout), Check);
    } else {
      hydroscope_wire::Batch batch;
      if (Read<Tolerant<hydroscope_wire::BatchPubSubType>>(data + 1, length, batch))
        assembler.Receive(ToMessage(std::move(batch)), {1, 1}, Check);
    }
    data += length + 1;
    size -= length + 1;
  }
  if (assembler.counters().lost_rows < 0) std::abort();
  return 0;
}
