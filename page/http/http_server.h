#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "core/result.h"
#include "page/http/event_feed.h"
#include "page/http/http_message.h"

namespace hydroscope {

/// Where a server listens.
struct HttpListen {
  std::optional<int> port;  ///< 0: a free one; nothing: no port
  std::string socket = {};  ///< path that only the owner may open, for other programs of his; "": none
  std::string address = "127.0.0.1";  ///< of the port, IPv4 or IPv6
  std::string certificate = {};       ///< PEM; with it and its key the port speaks TLS 1.2 or newer
  std::string key = {};               ///< PEM

  /// Only this computer reaches it.
  bool at_home() const;
};

/// HTTP by libmicrohttpd, one thread for all connections of a port and one for those of a socket: answers have to come at once.
class HttpServer {
 public:
  struct Hooks {
    /// Of the port, before a body is read: the refusal, or nothing; finds out who asks. What comes by the socket comes
    /// from the owner.
    std::function<std::optional<HttpReply>(HttpRequest&)> refuse;
    /// Where the body of this request is to be written; "" = into HttpRequest::body. Removed after the answer, or if the body ends
    /// early, where nobody moved it away.
    std::function<std::string(const HttpRequest&)> body_file;
    std::function<HttpReply(const HttpRequest&)> answer;
    std::string event_path;  ///< GET of it is an endless stream of `events` ...
    EventFeed* events = nullptr;
    std::function<bool(const HttpRequest&)>
        may_listen_on;  ///< ... asked again before each event; false ends the stream
  };
  /// Errors: no such address, the port is taken, certificate and key are none, another program answers on the socket, its path is
  /// too long or cannot be written. A socket that a dead program left behind is replaced.
  static Result<std::unique_ptr<HttpServer>> Open(const HttpListen& listen, Hooks hooks);
  /// Closes the feed, so that streams end, and removes the socket.
  ~HttpServer();
  /// 0 without one.
  int port() const;

 private:
  HttpServer();
  struct Door;
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace hydroscope
