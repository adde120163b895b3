#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "alarms/feeds/feed.h"
#include "alarms/feeds/feed_reader.h"
#include "alarms/feeds/tag.h"
#include "core/counted_words.h"

namespace hydroscope {

/// The registers of docs/register_map.md that these axes fill, from 1 in this order, with their values: read from the picture
/// the feed would serve; those that say something only while it is served (heartbeat, clock, ring) have none. Their names
/// speak of strokes or of episodes (`counted`); the addresses are the same. Alarms are numbered as AlarmNumbers does; those beyond the map are left out. `wall` in s since 1970.
std::vector<Tag> ModbusTags(const std::vector<AxisPicture>& axes,
                            const std::vector<std::pair<std::string, std::string>>& alarms_by_appearance,
                            double wall, const CountedWords& counted = {});

/// What a running feed serves (FeedStatus::registers) in the place of a tag of this type; nullopt: it serves nothing there.
std::optional<std::string> ServedValue(const std::vector<ServedRegisters>& served, int address,
                                       const std::string& type);

}  // namespace hydroscope
