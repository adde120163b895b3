#pragma once

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <string>
#include <vector>

#include "cli/finite_number.h"
#include "core/result.h"

namespace hydroscope {

/// Takes "NAME" (its typical size) or "NAME=SIZE" of an option --effect into the faults of a simulated machine. `all`: the table
/// of its faults, with `id`, `typical` and `size`, a pointer to the member of `Faults`.
template <typename Fault, typename Faults>
Status TakeFault(const std::string& text, const std::vector<Fault>& all, Faults& faults) {
  const auto equals = text.find('=');
  const std::string id = text.substr(0, equals);
  std::vector<std::string> known;
  for (const Fault& fault : all) {
    known.emplace_back(fault.id);
    if (id != fault.id) continue;
    const auto size =
        equals == std::string::npos ? std::optional(fault.typical) : FiniteNumber(text.substr(equals + 1));
    if (!size)
      return UsageError("--effect {}: expected NAME or NAME=NUMBER, e.g. {}={:g}", text, id, fault.typical);
    faults.*fault.size = *size;
    return {};
  }
  return UsageError("--effect {}: '{}' is not one of {}", text, id, fmt::join(known, ", "));
}

}  // namespace hydroscope
