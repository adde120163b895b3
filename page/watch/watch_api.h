#pragma once

#include <memory>

#include "page/api_route.h"
#include "page/http_message.h"
#include "page/watch/trend_cache.h"
#include "page/watch/watcher.h"

namespace hydroscope {

inline constexpr const char* kWatchPath = "watch/";  ///< below kApi

/// Answers /api/v1/watch/... (docs/page.md): a database as it is watched. Reads, but for actions on alarms, which go into the
/// journal as those of `hydroscope alarms` do.
class WatchApi {
 public:
  WatchApi(WatchOptions options, EventFeed& feed);
  /// Of one of these.
  HttpReply Answer(const HttpRequest& request);
  static std::vector<ApiRoute> Routes();

 private:
  struct Route;
  static const std::vector<Route>& Table();
  HttpReply Overview(const HttpRequest& request);
  HttpReply Alarms(const HttpRequest& request);
  HttpReply Tags(const HttpRequest& request);
  HttpReply Service(const HttpRequest& request);
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
