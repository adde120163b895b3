#pragma once

#include <memory>

#include "alarms/feeds/feed.h"
#include "alarms/feeds/feed_reader.h"
#include "core/clock.h"
#include "models/feeds_spec.h"

namespace hydroscope {

/// Journal rows on <topic>/alarms and the present state of every alarm on <topic>/findings, by DDS
/// (docs/live_protocol.md).
std::unique_ptr<Feed> MakeDdsFeed(DdsFeedSpec spec, FeedReader reader, Clock clock);

}  // namespace hydroscope
