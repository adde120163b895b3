#include "alarms/feeds/sparkplug/tags.h"

#include <fmt/format.h>

#include "alarms/feeds/sparkplug/payload.h"

namespace hydroscope {

std::vector<Tag> SparkplugTags(const SparkplugFeedSpec& spec, const std::string& machine,
                               const std::vector<AxisPicture>& axes, double wall) {
  std::vector<Tag> all;
  const std::string node = sparkplug::TopicPart(spec.node.empty() ? machine : spec.node);
  for (const AxisPicture& axis : axes)
    for (Tag& tag : sparkplug::TagsOf(sparkplug::DeviceBirth(axis, wall))) {
      tag.feed = SparkplugFeedSpec::kName;
      tag.axis = axis.machine;
      tag.address = fmt::format("spBv1.0/{}/DDATA/{}/{}", sparkplug::TopicPart(spec.group), node,
                                sparkplug::TopicPart(axis.name));
      all.push_back(std::move(tag));
    }
  return all;
}

}  // namespace hydroscope
