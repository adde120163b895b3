#pragma once

#include "page/http_message.h"
#include "page/work_session.h"

namespace hydroscope {

/// Answers what the page asks: /api/v1/... (docs/page.md lists it) and the files of the front end. Every answer of the API is a
/// JSON object with `schema`; a failure has `error`.
class PageApi {
 public:
  PageApi(WorkSession& session, std::string token) : session_(session), token_(std::move(token)) {}
  HttpReply Answer(const HttpRequest& request);
  /// Where the body of an upload goes; "" for all other requests.
  std::string BodyFile(const HttpRequest& request);

 private:
  HttpReply Asset(const std::string& path) const;

  WorkSession& session_;
  const std::string token_;
};

inline constexpr const char* kEventPath = "/api/v1/events";

}  // namespace hydroscope
