#include "models/machine.h"

namespace hydroscope {

int Machine::SignalIndex(std::string_view signal_name) const {
  for (std::size_t i = 0; i < signals.size(); ++i)
    if (signals[i].name == signal_name) return static_cast<int>(i);
  return -1;
}

std::optional<KnownValue> Machine::Geometry(const std::string& key) const {
  const auto found = geometry.find(key);
  if (found == geometry.end()) return std::nullopt;
  return found->second;
}

}  // namespace hydroscope
