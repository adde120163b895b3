#include "acquisition/list.h"

namespace hydroscope {

std::span<const SourceKind* const> SourceKinds() {
#define HYDROSCOPE_LIST_KIND(Name) &k##Name##SourceKind,
  static constexpr const SourceKind* kKinds[] = {HYDROSCOPE_SOURCES(HYDROSCOPE_LIST_KIND)};
#undef HYDROSCOPE_LIST_KIND
  return kKinds;
}

}  // namespace hydroscope
