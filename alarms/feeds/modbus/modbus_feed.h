#pragma once

#include <memory>

#include "alarms/feeds/feed.h"
#include "alarms/feeds/feed_reader.h"
#include "core/clock.h"
#include "models/feeds_spec.h"

namespace hydroscope {

/// The register map of docs/register_map.md at a Modbus TCP port. One thread takes journal and trends into
/// the registers ten times a second and stores acknowledgements, another one answers clients; a port that is
/// taken is tried again every second.
std::unique_ptr<Feed> MakeModbusFeed(ModbusFeedSpec spec, FeedReader reader, Clock clock);

}  // namespace hydroscope
