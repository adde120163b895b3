#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "acquisition/source.h"
#include "models/source_kind.h"

/// All sources of live signals. To add one, write its folder and a line here: k<Name>SourceKind says what a machine file holds
/// of it, Make<Name>Sources makes it.
#define HYDROSCOPE_SOURCES(_) \
  _(Dds)                      \
  _(Modbus)

namespace hydroscope {

#define HYDROSCOPE_DECLARE_SOURCE(Name)                                                                \
  extern const SourceKind k##Name##SourceKind;                                                         \
  /** What the machine file asks for: as many as are read by themselves. */                            \
  std::vector<std::unique_ptr<Source>> Make##Name##Sources(const Machine& machine, const Clock& clock, \
                                                           std::uint64_t seed);
HYDROSCOPE_SOURCES(HYDROSCOPE_DECLARE_SOURCE)
#undef HYDROSCOPE_DECLARE_SOURCE

}  // namespace hydroscope
