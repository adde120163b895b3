#include "page/access/gate.h"

#include "page/access/secrets.h"
#include "page/api_route.h"
#include "page/http/json_reply.h"

namespace hydroscope {

Gate::Gate(const std::string& owner) : owner_{owner, UserRole::kAdmin, RandomToken()} {}

Gate::Gate(Logins& logins, bool reads_freely, std::string cookie)
    : logins_(&logins), reads_freely_(reads_freely), cookie_(std::move(cookie)) {}

Who Gate::WhoAsks(const HttpRequest& request) {
  if (logins_ == nullptr) return owner_;
  const auto cookie = request.cookies.find(cookie_);
  return cookie == request.cookies.end() ? Who{} : logins_->Find(cookie->second);
}

std::optional<HttpReply> Gate::Refuse(HttpRequest& request) {
  request.who = WhoAsks(request);
  const UserRole needed = RoleNeeded(request.method, request.path), has = request.who.role;
  if (needed == UserRole::kNobody) return std::nullopt;
  const bool reads = request.method != "POST";
  if (reads && needed == UserRole::kView && reads_freely_) return std::nullopt;
  if (has == UserRole::kNobody) return ErrorReply(401, Told("log in first", "bitte erst anmelden"));
  if (has < needed)
    return ErrorReply(403, Tell("this needs the role {}; {} has the role {}",
                                "dazu gehört die Rolle {}; {} hat die Rolle {}", RoleName(needed),
                                request.who.name, RoleName(has)));
  if (!reads && !SameSecret(request.token, request.who.token))
    return ErrorReply(403, Told("the token is missing or old: load the page again (X-Hydroscope-Token)",
                                "das Token fehlt oder ist alt: die Seite neu laden (X-Hydroscope-Token)"));
  return std::nullopt;
}

}  // namespace hydroscope
