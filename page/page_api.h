#pragma once

#include <nlohmann/json_fwd.hpp>

#include "page/http_message.h"
#include "page/watch/watch_api.h"
#include "page/work_session.h"

namespace hydroscope {

/// Answers what the page asks: /api/v1/... (docs/page.md lists it) and the files of the front end. Every answer of the API is a
/// JSON object with `schema`; a failure has `error`.
class PageApi {
 public:
  /// `session`: nullptr where there is no workbench; `watch`: nullptr where no database is watched; `token` "": nothing can be
  /// changed.
  PageApi(WorkSession* session, WatchApi* watch, std::string token)
      : session_(session), watch_(watch), token_(std::move(token)) {}
  HttpReply Answer(const HttpRequest& request);
  /// Where the body of an upload goes; "" for all other requests.
  std::string BodyFile(const HttpRequest& request);

 private:
  nlohmann::json Session() const;
  HttpReply Asset(const std::string& path) const;

  WorkSession* const session_;
  WatchApi* const watch_;
  const std::string token_;
};

inline constexpr const char* kEventPath = "/api/v1/events";

}  // namespace hydroscope
