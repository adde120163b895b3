#pragma once

#include <memory>

#include "page/api_route.h"
#include "page/http/http_message.h"
#include "page/watch/learning.h"
#include "page/watch/trend_cache.h"
#include "page/watch/watcher.h"

namespace hydroscope {

inline constexpr const char* kWatchPath = "watch/";  ///< below kApi

/// Answers /api/v1/watch/... (docs/page.md): a database as it is watched. Reads, but for actions on alarms and references
/// learned, which go into the journal as those of `hydroscope alarms` and `learn` do.
class WatchApi {
 public:
  /// `jobs`: does what takes long.
  WatchApi(WatchOptions options, EventFeed& feed, JobQueue& jobs);
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
  HttpReply AskForValveCheck(const HttpRequest& request);
  HttpReply LastLearned(const HttpRequest& request);
  HttpReply Learn(const HttpRequest& request);
  HttpReply Act(const HttpRequest& request);
  /// Who acts: who is logged in, or on the page of one person whom he says.
  std::string Acting(const HttpRequest& request, const std::string& said) const;

  const WatchOptions options_;
  TrendCache trends_;
  Learning learning_;
  Watcher watcher_;
};

}  // namespace hydroscope
