#pragma once

#include <optional>
#include <string>
#include <vector>

#include "alarms/feeds/dds/settings.h"
#include "alarms/feeds/feed_reader.h"
#include "alarms/feeds/tag.h"

namespace hydroscope {

/// The members of the messages of dds/hydroscope_alarms.idl, in its order, with what they say: of <topic>/findings for each of
/// these axes and each of its alarms, of <topic>/alarms as the newest row of the journal has them; without a row no values.
std::vector<Tag> DdsTags(const DdsFeedSpec& spec, const std::vector<AxisPicture>& axes,
                         const std::optional<JournalRow>& newest);

}  // namespace hydroscope
