#include "alarms/feeds/feeds.h"

#include "alarms/feeds/feed_context.h"
#include "alarms/feeds/list.h"

namespace hydroscope {

Feeds Feeds::Start(const Machine& machine, const std::string& database, const Clock& clock,
                   std::shared_ptr<const HealthBoard> board) {
  Feeds started;
  if (!machine.feeds) return started;
  const FeedContext context{machine, database, clock, std::move(board)};
#define HYDROSCOPE_LIST_MAKER(Name) Make##Name##Feed,
  for (const auto make : {HYDROSCOPE_FEEDS(HYDROSCOPE_LIST_MAKER)})
    if (auto feed = make(context)) started.feeds_.push_back(std::move(feed));
#undef HYDROSCOPE_LIST_MAKER
  return started;
}

std::vector<FeedStatus> Feeds::status() const {
  std::vector<FeedStatus> all;
  for (const auto& feed : feeds_) all.push_back(feed->status());
  return all;
}

}  // namespace hydroscope
