#include "page/request_guard.h"

#include <fmt/format.h>
#include <sys/random.h>

#include <array>
#include <nlohmann/json.hpp>

#include "host/output.h"

namespace hydroscope {
namespace {

/// Takes as long whatever differs.
bool SameSecret(const std::string& a, const std::string& b) {
  if (a.size() != b.size() || b.empty()) return false;
  unsigned difference = 0;
  for (std::size_t i = 0; i < a.size(); ++i) difference |= static_cast<unsigned char>(a[i] ^ b[i]);
  return difference == 0;
}

bool IsOwnHost(const std::string& host, int port) {
  for (const char* name : {"127.0.0.1", "localhost", "[::1]"})
    if (host == fmt::format("{}:{}", name, port)) return true;
  return false;
}

}  // namespace

std::optional<HttpReply> RequestGuard::Refuse(const HttpRequest& request) const {
  if (!IsOwnHost(request.host, port))
    return ErrorReply(
        421,
        fmt::format("the Host header must be 127.0.0.1:{} or localhost:{}: the page is for this computer",
                    port, port));
  const bool reads = request.method == "GET" || request.method == "HEAD";
  if (!reads && request.method != "POST") return ErrorReply(405, "only GET and POST are answered");
  const bool own_page = request.fetch_site.empty() || request.fetch_site == "same-origin" ||
                        (request.fetch_site == "none" && reads);
  const bool api = request.path.starts_with("/api/");
  if (api && !own_page) return ErrorReply(403, "only the page itself may ask, not one of another site");
  if (reads) return std::nullopt;
  if (!request.origin.empty() && request.origin != "http://" + request.host)
    return ErrorReply(403, "the Origin header names another site");
  if (token.empty())
    return ErrorReply(
        403,
        "this page is to look at; what changes something is done with `hydroscope alarms`, or with "
        "`hydroscope open --db` beside the service");
  if (!SameSecret(request.token, token))
    return ErrorReply(403, "the token is missing or old: load the page again (X-Hydroscope-Token)");
  if (request.length > BodyLimit(request.path))
    return ErrorReply(413, fmt::format("{} bytes are more than the {} that are taken here", request.length,
                                       BodyLimit(request.path)));
  return std::nullopt;
}

std::string RandomToken() {
  std::array<unsigned char, 32> bytes{};
  if (getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size())) return "";
  std::string token;
  for (const unsigned char byte : bytes) token += fmt::format("{:02x}", byte);
  return token;
}

std::int64_t BodyLimit(const std::string& path) {
  if (path == "/api/v1/logs") return kMostUpload;
  return path == "/api/v1/machine" ? kMostMachine : kMostBody;
}

HttpReply ErrorReply(unsigned status, const std::string& text) {
  const nlohmann::json json = {{"schema", kJsonSchema}, {"error", text}};
  return {status, "application/json", json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace)};
}

}  // namespace hydroscope
