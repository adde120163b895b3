// libFuzzer target: whatever the text, ParseMachine gives a machine or an error, and a machine it gives reads
// back equal after writing.
#include <cstdint>
#include <cstdio>
#include <cstdlib>

#include "models/machine.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  const auto machine = hydroscope::ParseMachine(text, "fuzz");
  if (!machine) return machine.error().text.empty() ? std::abort(), 0 : 0;
  const auto again = hydroscope::ParseMachine(hydroscope::FormatMachine(*machine), "fuzz");
  if (!again || !(*again == *machine)) {
    std::fprintf(stderr, "%s\n%s\n", again ? "read back differently" : again.error().text.c_str(),
                 hydroscope::FormatMachine(*machine).c_str());
    std::abort();
  }
  return 0;
}
