#pragma once

#include <optional>
#include <string>

#include "page/http_message.h"

namespace hydroscope {

/// What a request has to fulfil before anything is read or done for it.
struct RequestGuard {
  int port = 0;       ///< of the server: the Host header must name it at a loopback name
  std::string token;  ///< that the page holds; what changes something must bring it; "": nothing may

  /// The refusal, or nothing: Host names another site (DNS rebinding), a page of another site asks (Sec-Fetch-Site, Origin),
  /// or a request that changes something lacks the token.
  std::optional<HttpReply> Refuse(const HttpRequest& request) const;
};

/// 32 bytes from the system, as hexadecimal digits. "" if the system gives none.
std::string RandomToken();

/// Most bytes of a body, by what it is for.
inline constexpr std::int64_t kMostBody = 256 * 1024, kMostMachine = 1024 * 1024, kMostUpload = 2LL << 30;
std::int64_t BodyLimit(const std::string& path);

/// {"schema", "error"}: every refusal and failure of the API has this form.
HttpReply ErrorReply(unsigned status, const std::string& text);

}  // namespace hydroscope
