#include "live/http_endpoint.h"

#include <arpa/inet.h>
#include <microhttpd.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstring>

namespace hydroscope {
namespace {

constexpr int kBacklog = 16;
constexpr unsigned kMostConnections = 32, kConnectionTimeout = 5;  // s

MHD_Result Reply(MHD_Connection* connection, unsigned code, const std::string& text, const char* type) {
  MHD_Response* response =
      MHD_create_response_from_buffer(text.size(), const_cast<char*>(text.data()), MHD_RESPMEM_MUST_COPY);
  MHD_add_response_header(response, MHD_HTTP_HEADER_CONTENT_TYPE, type);
  const MHD_Result queued = MHD_queue_response(connection, code, response);
  MHD_destroy_response(response);
  return queued;
}

/// A bound stream socket at `path`; one that a dead service left behind is replaced.
Result<int> ListenAt(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.size() >= sizeof(address.sun_path))
    return UsageError(
        "the path of the status socket {} is longer than {} characters; use a shorter database path", path,
        sizeof(address.sun_path) - 1);
  std::strcpy(address.sun_path, path.c_str());
  const int listener = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const int probe = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const auto* raw = reinterpret_cast<const sockaddr*>(&address);
  const bool alive = connect(probe, raw, sizeof(address)) == 0;
  close(probe);
  if (alive) {
    close(listener);
    return BadInput("{}: another service answers there already and writes this database; stop it first",
                    path);
  }
  unlink(path.c_str());
  if (bind(listener, raw, sizeof(address)) != 0 || listen(listener, kBacklog) != 0) {
    const std::string why = std::strerror(errno);
    close(listener);
    return InternalError("the status socket {} cannot be made: {}", path, why);
  }
  return listener;
}

}  // namespace

struct HttpEndpoint::Impl {
  Answers answers;
  MHD_Daemon* port = nullptr;
  MHD_Daemon* socket = nullptr;
  std::string socket_path;

  static MHD_Result Handle(void* self, MHD_Connection* connection, const char* url, const char* method,
                           const char*, const char*, std::size_t*, void** request) {
    static int begun;
    if (*request == nullptr) {  // the first call of a request brings its head only
      *request = &begun;
      return MHD_YES;
    }
    return static_cast<Impl*>(self)->Answer(connection, url, method);
  }

  MHD_Result Answer(MHD_Connection* connection, const std::string& url, const std::string& method) const {
    if (method == "GET" && url == "/metrics")
      return Reply(connection, MHD_HTTP_OK, answers.metrics(), "text/plain; version=0.0.4");
    if (method == "GET" && url == "/status")
      return Reply(connection, MHD_HTTP_OK, answers.status(), "application/json");
    if (method == "POST" && url == "/valve_check" && IsLocal(connection) && answers.valve_check) {
      const char* axis = MHD_lookup_connection_value(connection, MHD_GET_ARGUMENT_KIND, "axis");
      const Status asked = answers.valve_check(axis ? axis : "");
      return Reply(connection, asked ? MHD_HTTP_OK : MHD_HTTP_CONFLICT,
                   asked ? "asked\n" : asked.error().text, "text/plain");
    }
    return Reply(connection, MHD_HTTP_NOT_FOUND, "there are /metrics and /status\n", "text/plain");
  }

  /// True on the socket, which only its owner may open.
  bool IsLocal(MHD_Connection* connection) const {
    const auto* info = MHD_get_connection_info(connection, MHD_CONNECTION_INFO_DAEMON);
    return info != nullptr && info->daemon == socket;
  }
};

HttpEndpoint::HttpEndpoint() : impl_(std::make_unique<Impl>()) {}

HttpEndpoint::~HttpEndpoint() {
  if (impl_->port) MHD_stop_daemon(impl_->port);
  if (impl_->socket) MHD_stop_daemon(impl_->socket);
  if (!impl_->socket_path.empty()) unlink(impl_->socket_path.c_str());
}

Result<std::unique_ptr<HttpEndpoint>> HttpEndpoint::Open(int port, const std::string& socket,
                                                         Answers answers) {
  std::unique_ptr<HttpEndpoint> endpoint(new HttpEndpoint);
  Impl& impl = *endpoint->impl_;
  impl.answers = std::move(answers);
  const unsigned flags = MHD_USE_INTERNAL_POLLING_THREAD;
  if (port != 0) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    impl.port = MHD_start_daemon(flags, 0, nullptr, nullptr, &Impl::Handle, &impl, MHD_OPTION_SOCK_ADDR,
                                 &address, MHD_OPTION_CONNECTION_LIMIT, kMostConnections,
                                 MHD_OPTION_CONNECTION_TIMEOUT, kConnectionTimeout, MHD_OPTION_END);
    if (impl.port == nullptr)
      return BadInput(
          "port {} on 127.0.0.1 cannot be opened ({}); give another one with --port, or 0 for none", port,
          std::strerror(errno));
  }
  if (!socket.empty()) {
    const auto listener = ListenAt(socket);
    if (!listener) return tl::unexpected(listener.error());
    impl.socket = MHD_start_daemon(flags, 0, nullptr, nullptr, &Impl::Handle, &impl, MHD_OPTION_LISTEN_SOCKET,
                                   *listener, MHD_OPTION_CONNECTION_LIMIT, kMostConnections,
                                   MHD_OPTION_CONNECTION_TIMEOUT, kConnectionTimeout, MHD_OPTION_END);
    if (impl.socket == nullptr) return InternalError("the status socket {} cannot be served", socket);
    impl.socket_path = socket;
  }
  return endpoint;
}

std::string SocketOf(const std::string& database) { return database + ".sock"; }

Result<std::string> AskService(const std::string& path, const std::string& method, const std::string& what) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.size() >= sizeof(address.sun_path))
    return UsageError("the path {} is too long for a socket", path);
  std::strcpy(address.sun_path, path.c_str());
  const int link = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const timeval patience{5, 0};
  setsockopt(link, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof(patience));
  if (connect(link, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0) {
    close(link);
    return BadInput("no service answers at {}; is `hydroscope serve` running with this database?", path);
  }
  const std::string request = fmt::format("{} {} HTTP/1.0\r\n\r\n", method, what);
  std::string answer;
  if (send(link, request.data(), request.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(request.size())) {
    char piece[4096];
    for (ssize_t got = 0; (got = recv(link, piece, sizeof(piece), 0)) > 0;)
      answer.append(piece, static_cast<std::size_t>(got));
  }
  close(link);
  const std::size_t body = answer.find("\r\n\r\n");
  if (body == std::string::npos) return InternalError("the service at {} gave no answer within 5 s", path);
  if (answer.find(" 200 ") > answer.find("\r\n"))
    return BadInput("the service says: {}", answer.substr(body + 4));
  return answer.substr(body + 4);
}

}  // namespace hydroscope
