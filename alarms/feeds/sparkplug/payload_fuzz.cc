// libFuzzer target: whatever bytes a broker hands over as a Sparkplug payload, they are a payload or none;
// sealing keeps what they say.
#include <cstdlib>

#include "alarms/feeds/sparkplug/payload.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace hydroscope::sparkplug;
  const std::string bytes(reinterpret_cast<const char*>(data), size);
  const bool rebirth = AsksForRebirth(bytes);
  const auto row = RowOf(bytes);
  const auto sealed = Sealed(bytes, 7, size % 2 == 0);
  if (!sealed) {
    if (rebirth || row) std::abort();
    return 0;
  }
  if (AsksForRebirth(*sealed) != rebirth) std::abort();
  const auto again = RowOf(*sealed);
  if (again.has_value() != row.has_value()) std::abort();
  if (row &&
      (again->sequence != row->sequence || again->alarm != row->alarm || again->comment != row->comment))
    std::abort();
  if (TopicPart(bytes).find_first_of("/+#") != std::string::npos) std::abort();
  return 0;
}
