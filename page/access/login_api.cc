#include "page/access/login_api.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "page/access/secrets.h"
#include "page/http/json_arguments.h"
#include "page/http/json_reply.h"
#include "page/http/request_guard.h"

namespace hydroscope {
namespace {

constexpr std::int64_t kMostAuditRows = 500;  ///< told, the newest

}  // namespace

nlohmann::json UserJson(const Who& who) {
  if (who.role == UserRole::kNobody) return nullptr;
  return {{"name", who.name}, {"role", RoleName(who.role)}, {"token", who.token}};
}

nlohmann::json AuditJson(const AuditRow& row) {
  return {{"sequence", row.sequence}, {"wall_s", row.wall}, {"user", row.user},     {"role", row.role},
          {"address", row.from},      {"what", row.what},   {"detail", row.detail}, {"outcome", row.outcome}};
}

nlohmann::json LoginApi::Json() { return {{"to_read", to_read_}, {"users", logins_.AnyUsers()}}; }

HttpReply LoginApi::Answer(const HttpRequest& request) {
  if (request.path.ends_with("/login")) return Login(request);
  return request.path.ends_with("/logout") ? Logout(request) : Audit();
}

/// Scripts of the page cannot read it, and no other site can have it sent.
std::pair<std::string, std::string> LoginApi::Cookie(const std::string& value, double seconds) const {
  return {"Set-Cookie", fmt::format("{}={}; Path=/; Max-Age={:.0f}; HttpOnly; SameSite=Strict{}", cookie_,
                                    value, seconds, tls_ ? "; Secure" : "")};
}

HttpReply LoginApi::Login(const HttpRequest& request) {
  const auto json = ParseObject(request.body);
  if (!json) return FailureReply(json.error());
  const auto name = TextOf(*json, "name"), password = TextOf(*json, "password", kLongestPassword);
  if (!name) return FailureReply(name.error());
  if (!password) return FailureReply(password.error());
  const auto begun = logins_.Begin(*name, *password, request.from);
  if (!begun) return FailureReply(begun.error());
  if (begun->wait > 0) {
    HttpReply reply = ErrorReply(
        429, Tell("too many attempts; try again in {:.0f} min",
                  "zu viele Versuche; in {:.0f} min wieder versuchen", std::ceil(begun->wait / 60)));
    reply.headers = {{"Retry-After", fmt::format("{:.0f}", std::ceil(begun->wait))}};
    return reply;
  }
  if (begun->cookie.empty())
    return ErrorReply(401, Told("name or password is wrong", "Name oder Passwort ist falsch"));
  HttpReply reply = JsonReply({{"user", UserJson(begun->who)}});
  reply.headers = {Cookie(begun->cookie, Logins::kLife)};
  return reply;
}

HttpReply LoginApi::Logout(const HttpRequest& request) {
  const auto cookie = request.cookies.find(cookie_);
  const Status ended = logins_.End(cookie == request.cookies.end() ? "" : cookie->second);
  if (!ended) return FailureReply(ended.error());
  HttpReply reply = JsonReply(nlohmann::json::object());
  reply.headers = {Cookie("", 0)};
  return reply;
}

HttpReply LoginApi::Audit() {
  const auto rows = logins_.Audit(kMostAuditRows);
  if (!rows) return FailureReply(rows.error());
  nlohmann::json list = nlohmann::json::array();
  for (const AuditRow& row : *rows) list.push_back(AuditJson(row));
  return JsonReply({{"audit", std::move(list)}});
}

}  // namespace hydroscope
