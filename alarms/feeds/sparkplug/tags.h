#pragma once

#include <string>
#include <vector>

#include "alarms/feeds/feed_reader.h"
#include "alarms/feeds/sparkplug/settings.h"
#include "alarms/feeds/tag.h"

namespace hydroscope {

/// What the Sparkplug node `machine` would tell of these axes: the metrics of their births, by topic. `wall` in s since 1970.
std::vector<Tag> SparkplugTags(const SparkplugFeedSpec& spec, const std::string& machine,
                               const std::vector<AxisPicture>& axes, double wall);

}  // namespace hydroscope
