#include "alarms/feeds/list.h"

namespace hydroscope {

std::span<const FeedSection* const> FeedSections() {
#define HYDROSCOPE_LIST_SECTION(Name) &k##Name##FeedSection,
  static constexpr const FeedSection* kSections[] = {HYDROSCOPE_FEEDS(HYDROSCOPE_LIST_SECTION)};
#undef HYDROSCOPE_LIST_SECTION
  return kSections;
}

}  // namespace hydroscope
