#include "models/machine.h"

#include "core/units.h"

namespace hydroscope {

int Machine::SignalIndex(std::string_view signal_name) const {
  for (std::size_t i = 0; i < signals.size(); ++i)
    if (signals[i].name == signal_name) return static_cast<int>(i);
  return -1;
}

bool Machine::IsShare(std::string_view signal_name) const {
  const int signal = SignalIndex(signal_name);
  const auto unit = signal < 0 ? std::nullopt : FindUnit(signals[static_cast<std::size_t>(signal)].unit);
  return unit && unit->si == "1";
}

std::optional<KnownValue> Machine::Geometry(const std::string& key) const {
  const auto found = geometry.find(key);
  if (found == geometry.end()) return std::nullopt;
  return found->second;
}

}  // namespace hydroscope
