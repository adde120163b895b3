#pragma once

#include <nlohmann/json_fwd.hpp>

#include "page/access/login_api.h"
#include "page/http/http_message.h"
#include "page/watch/watch_api.h"
#include "page/work/work_session.h"

namespace hydroscope {

/// Answers what the page asks: /api/v1/... (docs/openapi.json) and the files of the front end. Every answer of the API is a
/// JSON object with `schema`; a failure has `error`. Whether who asks may is not looked at here (Gate).
class PageApi {
 public:
  /// `session`: nullptr where there is no workbench; `watch`: where no database is watched; `login`: where nobody logs in.
  PageApi(WorkSession* session, WatchApi* watch, LoginApi* login)
      : session_(session), watch_(watch), login_(login) {}
  HttpReply Answer(const HttpRequest& request);
  /// Where the body of an upload goes; "" for all other requests.
  std::string BodyFile(const HttpRequest& request);

 private:
  nlohmann::json Session(const Who& who) const;
  static HttpReply Asset(const std::string& path);

  WorkSession* const session_;
  WatchApi* const watch_;
  LoginApi* const login_;
};

inline constexpr const char* kEventPath = "/api/v1/events";

}  // namespace hydroscope
