#include "models/source_kind.h"

#include <algorithm>

namespace hydroscope {

const SourceKind* FindSourceKind(std::string_view name) {
  const auto kinds = SourceKinds();
  const auto at =
      std::find_if(kinds.begin(), kinds.end(), [&](const SourceKind* k) { return k->name == name; });
  return at == kinds.end() ? nullptr : *at;
}

Delivery DeliveryOf(const Machine& machine, const SignalSpec& signal) {
  return FindSourceKind(signal.origin->part())->delivery(machine, signal);
}

}  // namespace hydroscope
