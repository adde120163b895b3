#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "core/result.h"
#include "page/event_feed.h"
#include "page/http_message.h"

namespace hydroscope {

/// HTTP on 127.0.0.1 by libmicrohttpd, one thread for all connections: answers have to come at once.
class HttpServer {
 public:
  struct Hooks {
    /// Before a body is read: the refusal, or nothing.
    std::function<std::optional<HttpReply>(const HttpRequest&)> refuse;
    /// Where the body of this request is to be written; "" = into HttpRequest::body.
    std::function<std::string(const HttpRequest&)> body_file;
    std::function<HttpReply(const HttpRequest&)> answer;
    std::string event_path;  ///< GET of it is an endless stream of `events`
    EventFeed* events = nullptr;
  };
  /// `port` 0: a free one. Errors: the port is taken.
  static Result<std::unique_ptr<HttpServer>> Open(int port, Hooks hooks);
  /// Closes the feed, so that streams end.
  ~HttpServer();
  int port() const;

 private:
  HttpServer();
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace hydroscope
