#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "replay/csv_reader.h"
#include "replay/log_layout.h"
#include "replay/memory_source_fixture.h"

namespace {

/// A machine whose columns are the first ones found, so that rows are read and not only refused.
hydroscope::Machine MachineFor(const hydroscope::LogLayout& layout) {
  hydroscope::Machine machine;
  for (std::size_t i = 1; i < layout.names.size() && i < 4; ++i) {
    hydroscope::SignalSpec spec;
    spec.name = spec.column = layout.names[i];
    machine.signals.push_back(spec);
  }
  machine.log.time_column = layout.names.size() % 2 == 0 ? layout.names.front() : "";
  machine.log.sample_period = 0.002;
  return machine;
}

void Require(bool condition) {
  if (!condition) std::abort();
}

}  // namespace

/// Any bytes: layout detection and reading end without crash, deliver finite values or values flagged as missing.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  const auto layout = hydroscope::DetectLayout(text, {}, "fuzz");
  if (!layout) return 0;
  auto reader = hydroscope::CsvReader::Open(std::make_unique<hydroscope::MemorySource>(text),
                                            MachineFor(*layout), "fuzz");
  if (!reader) return 0;
  hydroscope::SampleBlock block;
  for (auto rows = (*reader)->Read(block, 7); rows && *rows > 0; rows = (*reader)->Read(block, 7)) {
    for (std::size_t row = 0; row < *rows; ++row) {
      Require(std::isfinite(block.time[row]));
      for (std::size_t s = 0; s < block.signal.size(); ++s)
        Require(std::isfinite(block.signal[s][row]) ||
                (block.quality[s][row] & hydroscope::quality::kMissing) != 0);
    }
  }
  return 0;
}
