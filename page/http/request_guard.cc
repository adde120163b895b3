#include "page/http/request_guard.h"

#include <arpa/inet.h>
#include <fmt/format.h>

#include "core/contains.h"
#include "page/http/json_reply.h"

namespace hydroscope {
namespace {

/// "192.168.1.20", "[fe80::1]": nobody can bind a name to what has none.
bool IsAddress(const std::string& host) {
  unsigned char bytes[16];
  if (host.size() > 2 && host.front() == '[' && host.back() == ']')
    return inet_pton(AF_INET6, host.substr(1, host.size() - 2).c_str(), bytes) == 1;
  return inet_pton(AF_INET, host.c_str(), bytes) == 1;
}

}  // namespace

bool RequestGuard::IsOwnHost(const std::string& host) const {
  std::string name = host;
  const std::string end = fmt::format(":{}", port);
  const bool names_port = name.ends_with(end);
  if (names_port) name.resize(name.size() - end.size());
  if (!names_port && port != (tls ? 443 : 80)) return false;
  if (name == "127.0.0.1" || name == "localhost" || name == "[::1]") return true;
  return Contains(names, name) || (!at_home && IsAddress(name));
}

std::optional<HttpReply> RequestGuard::Refuse(const HttpRequest& request) const {
  if (!IsOwnHost(request.host))
    return ErrorReply(
        421, at_home
                 ? fmt::format(
                       "the Host header must be 127.0.0.1:{} or localhost:{}: the page is for this computer",
                       port, port)
                 : fmt::format("the Host header must be an address of this computer, or a name given with "
                               "--host-name, and port {}",
                               port));
  const bool reads = request.method == "GET" || request.method == "HEAD";
  if (!reads && request.method != "POST") return ErrorReply(405, "only GET and POST are answered");
  const bool own_page = request.fetch_site.empty() || request.fetch_site == "same-origin" ||
                        (request.fetch_site == "none" && reads);
  const bool api = request.path.starts_with("/api/");
  if (api && !own_page) return ErrorReply(403, "only the page itself may ask, not one of another site");
  if (reads) return std::nullopt;
  if (!request.origin.empty() && request.origin != (tls ? "https://" : "http://") + request.host)
    return ErrorReply(403, "the Origin header names another site");
  if (request.length > BodyLimit(request.path))
    return ErrorReply(413, Tell("{} bytes are more than the {} that are taken here",
                                "{} Bytes sind mehr als die {}, die hier angenommen werden", request.length,
                                BodyLimit(request.path)));
  return std::nullopt;
}

std::int64_t BodyLimit(const std::string& path) {
  if (path == "/api/v1/logs") return kMostUpload;
  return path == "/api/v1/machine" ? kMostMachine : kMostBody;
}

}  // namespace hydroscope
