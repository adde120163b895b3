#pragma once

#include <optional>
#include <string>

#include "page/access/logins.h"
#include "page/http/http_message.h"

namespace hydroscope {

/// Finds out who asks and whether he may.
class Gate {
 public:
  /// The page of one person: whoever can open connections of this computer may do everything, under his name; what changes
  /// something needs a token that only the page itself can read.
  explicit Gate(const std::string& owner);
  /// The page of a service. `reads_freely`: looking needs no login. `cookie`: its name.
  Gate(Logins& logins, bool reads_freely, std::string cookie);

  /// Sets HttpRequest::who. The refusal, or nothing.
  std::optional<HttpReply> Refuse(HttpRequest& request);
  Who WhoAsks(const HttpRequest& request);

 private:
  const Who owner_;
  Logins* const logins_ = nullptr;
  const bool reads_freely_ = true;
  const std::string cookie_;
};

}  // namespace hydroscope
