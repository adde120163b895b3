#include "core/utc_text.h"

#include <fmt/chrono.h>

namespace hydroscope {

std::string UtcText(double wall) {
  return fmt::format("{:%Y-%m-%d %H:%M:%S}", fmt::gmtime(static_cast<std::time_t>(wall)));
}

}  // namespace hydroscope
