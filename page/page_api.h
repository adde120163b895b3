#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>

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
  /// Before a body is read: the refusal of an upload that there is no room for, or nothing.
  std::optional<HttpReply> Refuse(const HttpRequest& request) const;
  /// Where the body of an upload goes; "" for all other requests.
  std::string BodyFile(const HttpRequest& request);

 private:
  bool IsUpload(const HttpRequest& request) const;
  nlohmann::json Session(const Who& who) const;
  static HttpReply Asset(const std::string& path);

  WorkSession* const session_;
  WatchApi* const watch_;
  LoginApi* const login_;
};

inline constexpr const char* kEventPath = "/api/v1/events";

}  // namespace hydroscope
