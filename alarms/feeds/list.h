#pragma once

#include <memory>

#include "alarms/feeds/feed.h"
#include "models/machine_file/feed_section.h"

/// All feeds. To add one, write its folder and a line here: k<Name>FeedSection says what its section of the machine file holds,
/// Make<Name>Feed makes it.
#define HYDROSCOPE_FEEDS(_) \
  _(Modbus)                 \
  _(Dds)                    \
  _(Sparkplug)

namespace hydroscope {

struct FeedContext;

#define HYDROSCOPE_DECLARE_FEED(Name)                   \
  extern const FeedSection k##Name##FeedSection;        \
  /** nullptr: the machine file does not ask for it. */ \
  std::unique_ptr<Feed> Make##Name##Feed(const FeedContext& context);
HYDROSCOPE_FEEDS(HYDROSCOPE_DECLARE_FEED)
#undef HYDROSCOPE_DECLARE_FEED

}  // namespace hydroscope
