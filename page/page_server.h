#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/result.h"
#include "page/work_session.h"

namespace hydroscope {

struct PageOptions {
  std::vector<std::string> logs;
  std::string machine;  ///< "" = made on the page
  int port = 0;         ///< 0 = a free one
  std::vector<ExampleLog> examples;
};

/// The page over logs, served on 127.0.0.1 until it is destroyed.
class PageServer {
 public:
  /// Errors: the machine file is wrong, the port is taken, or the program was built without the page.
  static Result<std::unique_ptr<PageServer>> Open(const PageOptions& options);
  ~PageServer();
  std::string address() const;
  /// Has to be called every few seconds: finds browsers that are gone.
  void KeepAlive();

 private:
  PageServer();
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace hydroscope
