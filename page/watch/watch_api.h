#pragma once

#include <memory>

#include "page/http_message.h"
#include "page/watch/trend_cache.h"
#include "page/watch/watcher.h"

namespace hydroscope {

inline constexpr const char* kWatchPath = "/api/v1/watch/";

/// Answers /api/v1/watch/... (docs/page.md): a database as it is watched. Reads, but for actions on alarms, which go into the
/// journal as those of `hydroscope alarms` do.
class WatchApi {
 public:
  WatchApi(WatchOptions options, EventFeed& feed);
  HttpReply Answer(const HttpRequest& request);

 private:
  HttpReply Trend(const HttpRequest& request);
  HttpReply Stroke(const HttpRequest& request);
  HttpReply Journal(const HttpRequest& request);
  HttpReply ValveChecks(const HttpRequest& request);
  HttpReply Act(const HttpRequest& request);

  const WatchOptions options_;
  TrendCache trends_;
  Watcher watcher_;
};

}  // namespace hydroscope
