#pragma once

#include <optional>
#include <string>
#include <vector>

#include "page/http/http_message.h"

namespace hydroscope {

/// What a request has to fulfil whoever asks, before anything is read or done for it.
struct RequestGuard {
  int port = 0;                         ///< of the server: the Host header must name it ...
  bool at_home = true;                  ///< ... at a loopback name, else at any address ...
  std::vector<std::string> names = {};  ///< ... or at one of these
  bool tls = false;

  /// The refusal, or nothing: Host is a name that may have been bound to this computer (DNS rebinding), a page of another site
  /// asks (Sec-Fetch-Site, Origin), or the body is too long.
  std::optional<HttpReply> Refuse(const HttpRequest& request) const;

 private:
  bool IsOwnHost(const std::string& host) const;
};

/// Most bytes of a body, by what it is for.
inline constexpr std::int64_t kMostBody = 256 * 1024, kMostMachine = 1024 * 1024, kMostUpload = 2LL << 30;
std::int64_t BodyLimit(const std::string& path);

}  // namespace hydroscope
