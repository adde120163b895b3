// libFuzzer target: whatever a controller answers, registers become readings of the planned size, and the
// ring's rows are numbered without a row twice.
#include <cstdlib>
#include <cstring>

#include "acquisition/modbus/ring_reader.h"

namespace {

using namespace hydroscope;

/// Hands out the input as registers; zeros at its end.
class Controller {
 public:
  Controller(const std::uint8_t* data, std::size_t size) : data_(data), size_(size) {}
  bool at_end() const { return size_ == 0; }
  std::vector<std::uint16_t> Answer(std::size_t count) {
    std::vector<std::uint16_t> words(count);
    const std::size_t bytes = std::min(size_, 2 * count);
    if (bytes > 0) std::memcpy(words.data(), data_, bytes);
    data_ += bytes;
    size_ -= bytes;
    return words;
  }

 private:
  const std::uint8_t* data_;
  std::size_t size_;
};

void FuzzBlock(Controller& controller) {
  ReadBlock block{.first = 0, .count = 20, .values = {}, .heartbeat = 3, .time = 4};
  for (int type = 0; type < 8; ++type)
    block.values.push_back({2 * type, static_cast<RegisterType>(type), static_cast<WordOrder>(type % 4),
                            static_cast<std::uint16_t>(type)});
  const auto words = controller.Answer(1);
  const SampleBatch batch = DecodeBlock(block, controller.Answer(words[0] % 32));
  if (batch.values.size() != block.values.size() || batch.rows != 1) std::abort();
}

void FuzzRing(Controller& controller) {
  const ModbusRingSpec spec{.session = 0,
                            .newest = 2,
                            .time = 4,
                            .first = 100,
                            .records = 16,
                            .width = 10,
                            .period = 1e-3,
                            .poll_period = 1e-3};
  RingReader reader(spec, {{2, RegisterType::kFloat64, WordOrder::kCdab, 0},
                           {6, RegisterType::kInt64, WordOrder::kBadc, 1}});
  std::uint64_t session = 0, next = 0;
  const auto check = [&](SampleBatch&& batch) {
    if (batch.values.size() != 2 * batch.rows || batch.rows == 0) std::abort();
    if (batch.session == session && batch.first_sequence < next) std::abort();
    session = batch.session;
    next = batch.first_sequence + batch.rows;
  };
  while (!controller.at_end()) {
    const auto size = controller.Answer(1)[0];
    const auto head = controller.Answer(size % 16 == 0 ? 3 : 8);
    for (const RingReader::Request& request : reader.Begin(head)) {
      if (request.registers.first < 100 || request.registers.first + request.registers.count > 100 + 160)
        std::abort();
      if (request.registers.count > 125) std::abort();
      auto words = controller.Answer(static_cast<std::size_t>(request.registers.count));
      // Every second answer has the expected numbers, else no row would ever be taken.
      if (size % 2 == 0)
        for (std::size_t k = 0; k < request.records; ++k)
          EncodeUnsigned((request.sequence + k) & 0xffffffff, std::span(words).subspan(10 * k, 2));
      reader.Receive(request, words, {1, 1}, {2, 2}, check);
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 1) return 0;
  Controller controller(data + 1, size - 1);
  if (data[0] % 2 == 0)
    FuzzBlock(controller);
  else
    FuzzRing(controller);
  return 0;
}
