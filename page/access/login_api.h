#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "page/access/logins.h"
#include "page/api_route.h"
#include "page/http/http_message.h"

namespace hydroscope {

/// Answers `login`, `logout` and `audit` of the page of a service.
class LoginApi {
 public:
  /// `cookie`: its name; `tls`: it is sent by TLS alone; `to_read`: looking needs a login too.
  LoginApi(Logins& logins, std::string cookie, bool tls, bool to_read)
      : logins_(logins), cookie_(std::move(cookie)), tls_(tls), to_read_(to_read) {}
  HttpReply Answer(const HttpRequest& request);
  /// What the page has to know before anybody is logged in: `to_read`, `users` (there are any).
  nlohmann::json Json();

 private:
  HttpReply Login(const HttpRequest& request);
  HttpReply Logout(const HttpRequest& request);
  HttpReply Audit();
  std::pair<std::string, std::string> Cookie(const std::string& value, double seconds) const;

  Logins& logins_;
  const std::string cookie_;
  const bool tls_, to_read_;
};

inline constexpr ApiRoute kLoginRoutes[] = {
    {"POST", "login", UserRole::kNobody}, {"POST", "logout"}, {"GET", "audit", UserRole::kAdmin}};

/// A row of the audit table as page and command line give it.
nlohmann::json AuditJson(const AuditRow& row);

/// What the page has to know of who asks: `name`, `role`, `token`; null of nobody.
nlohmann::json UserJson(const Who& who);

}  // namespace hydroscope
