#pragma once

#include <memory>

#include "alarms/feeds/feed.h"
#include "alarms/feeds/feed_reader.h"
#include "core/clock.h"
#include "models/feeds_spec.h"

namespace hydroscope {

/// An MQTT Sparkplug B 3.0 edge node (docs/sparkplug.md): the node is the machine, each axis a device. Rows
/// of the journal go through the outbox at `outbox_path` and leave it when the broker has acknowledged them;
/// state and parameters are told as they are now.
std::unique_ptr<Feed> MakeSparkplugFeed(SparkplugFeedSpec spec, FeedReader reader, std::string outbox_path,
                                        Clock clock);

}  // namespace hydroscope
