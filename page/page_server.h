#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/result.h"
#include "page/http/http_server.h"
#include "page/watch/watch_options.h"
#include "page/work/work_session.h"

namespace hydroscope {

struct PageOptions {
  std::vector<std::string> logs;
  std::string machine;  ///< "" = made on the page
  int port = 0;         ///< 0 = a free one
  std::vector<ExampleLog> examples;
  WatchOptions watch;  ///< a database beside the logs
};

/// What `serve` shows: the database it writes. What changes something needs a login; so does looking, once other computers
/// reach the port, and then it speaks TLS.
struct ServicePageOptions {
  HttpListen listen;
  std::vector<std::string> host_names;  ///< under which other computers reach it, besides its addresses
  WatchOptions watch;
  /// Answers beside the page: /metrics, /status, and by the socket POST /valve_check; nothing: it is the page's.
  std::function<std::optional<HttpReply>(const HttpRequest&)> service;
};

/// The page over logs or a database, served until it is destroyed.
class PageServer {
 public:
  /// Errors: the machine file is wrong, the database cannot be read, the port is taken, or the program was built
  /// without the page.
  static Result<std::unique_ptr<PageServer>> Open(const PageOptions& options);
  /// The workbench is one for all who are logged in. A program that was built without the page serves the rest. Errors as of HttpServer::Open, and other
  /// computers would reach it without TLS.
  static Result<std::unique_ptr<PageServer>> OpenForService(const ServicePageOptions& options);
  ~PageServer();
  std::string address() const;
  /// Has to be called every few seconds: finds browsers that are gone.
  void KeepAlive();

 private:
  PageServer();
  Status Listen(const HttpListen& listen, std::function<HttpReply(const HttpRequest&)> answer);
  HttpReply AnswerRecorded(const HttpRequest& request);
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace hydroscope
