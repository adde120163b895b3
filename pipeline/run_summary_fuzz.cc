// libFuzzer target: whatever text the database holds as the summary of a run, it reads as a summary, and what
// was read is written and read back the same.
#include <cstdlib>

#include "pipeline/run_summary.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace hydroscope;
  const std::string written =
      FormatRunSummary(ParseRunSummary(std::string(reinterpret_cast<const char*>(data), size)));
  if (FormatRunSummary(ParseRunSummary(written)) != written) std::abort();
  return 0;
}
