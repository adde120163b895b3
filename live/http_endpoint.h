#pragma once

#include <functional>
#include <memory>
#include <string>

#include "core/result.h"

namespace hydroscope {

/// Answers of the service to people and monitoring: GET /metrics (Prometheus text), GET /status (JSON) and,
/// on the socket only, POST /valve_check?axis=NAME. Read only on the port, which listens on 127.0.0.1.
class HttpEndpoint {
 public:
  struct Answers {
    std::function<std::string()> metrics, status;
    std::function<Status(const std::string& axis)> valve_check;
  };
  /// `port` 0: none; `socket` "": none. Errors: port taken, path too long or not writable.
  static Result<std::unique_ptr<HttpEndpoint>> Open(int port, const std::string& socket, Answers answers);
  ~HttpEndpoint();

 private:
  HttpEndpoint();
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// The socket of the service that writes `database`.
std::string SocketOf(const std::string& database);

/// Asks the service on that socket. Errors: nobody answers there, or the answer is no success (its text).
Result<std::string> AskService(const std::string& socket, const std::string& method, const std::string& path);

}  // namespace hydroscope
