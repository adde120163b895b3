#include "page/http/http_server.h"

#include <arpa/inet.h>
#include <microhttpd.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "page/http/connection_places.h"
#include "page/http/json_reply.h"
#include "page/http/request_guard.h"

namespace hydroscope {

/// A connection of the port, from its first byte on.
struct PortConnection {
  ConnectionPlaces* places;
  ConnectionPlaces::Id id = 0;
  bool of_user = false;  ///< the request under way is of somebody logged in
  bool listens = false;  ///< to events, and may be suspended
  bool leaves = false;

  void Asked(const HttpRequest& request) {
    of_user = request.who.role != UserRole::kNobody;
    places->Uses(id, of_user ? ConnectionPlaces::Use::kUser : ConnectionPlaces::Use::kGuest);
  }
  void Answered() const {
    places->Uses(id, of_user ? ConnectionPlaces::Use::kUserRests : ConnectionPlaces::Use::kRests);
  }
};

namespace {

constexpr unsigned kMostConnections = 320;       ///< of all pages that are open
constexpr unsigned kMostOfOneAddress = 64;       ///< of these, where other computers reach the port
constexpr unsigned kLeaving = 80;                ///< more of them that were told to leave and have not yet
constexpr unsigned kIdle = 30;                   ///< s without a byte after which a connection is closed
constexpr std::size_t kMostHeaders = 32 * 1024;  ///< bytes of a connection's buffers, head included
constexpr std::size_t kEventPiece = 4096;        ///< bytes of a stream handed over at a time

/// What every answer carries: nothing from elsewhere is loaded, and no other page may show this one.
constexpr std::pair<const char*, const char*> kHeaders[] = {
    {"Content-Security-Policy",
     "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; font-src 'self'; connect-src "
     "'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"},
    {"X-Content-Type-Options", "nosniff"},
    {"X-Frame-Options", "DENY"},
    {"Referrer-Policy", "no-referrer"},
    {"Cross-Origin-Opener-Policy", "same-origin"},
    {"Cross-Origin-Resource-Policy", "same-origin"}};

struct OpenRequest {
  HttpRequest request;
  std::ofstream file = {};
  std::int64_t received = 0;

  ~OpenRequest() {
    if (!request.file.empty()) unlink(request.file.c_str());  // was not kept
  }
};

/// Null by the socket.
PortConnection* PlaceOf(MHD_Connection* connection) {
  const auto* info = MHD_get_connection_info(connection, MHD_CONNECTION_INFO_SOCKET_CONTEXT);
  return info == nullptr ? nullptr : static_cast<PortConnection*>(info->socket_context);
}

struct EventStream {
  const HttpServer::Hooks* hooks;
  MHD_Connection* connection;
  HttpRequest request;
  std::uint64_t position;
};

std::string Header(MHD_Connection* connection, const char* name) {
  const char* value = MHD_lookup_connection_value(connection, MHD_HEADER_KIND, name);
  return value == nullptr ? "" : value;
}

MHD_Result AddValue(void* values, MHD_ValueKind, const char* name, const char* value) {
  (*static_cast<std::map<std::string, std::string>*>(values))[name] = value == nullptr ? "" : value;
  return MHD_YES;
}

/// Address of the other end, without its port.
std::string AddressOf(MHD_Connection* connection) {
  const auto* info = MHD_get_connection_info(connection, MHD_CONNECTION_INFO_CLIENT_ADDRESS);
  char text[INET6_ADDRSTRLEN] = "";
  if (info == nullptr || info->client_addr == nullptr) return text;
  const sockaddr* other = info->client_addr;
  if (other->sa_family == AF_INET)
    inet_ntop(AF_INET, &reinterpret_cast<const sockaddr_in*>(other)->sin_addr, text, sizeof(text));
  if (other->sa_family == AF_INET6)
    inet_ntop(AF_INET6, &reinterpret_cast<const sockaddr_in6*>(other)->sin6_addr, text, sizeof(text));
  return text;
}

HttpRequest HeadOf(MHD_Connection* connection, const char* url, const char* method) {
  HttpRequest request;
  request.method = method;
  request.path = url;
  MHD_get_connection_values(connection, MHD_GET_ARGUMENT_KIND, AddValue, &request.query);
  MHD_get_connection_values(connection, MHD_COOKIE_KIND, AddValue, &request.cookies);
  request.from = AddressOf(connection);
  request.host = Header(connection, "Host");
  request.origin = Header(connection, "Origin");
  request.fetch_site = Header(connection, "Sec-Fetch-Site");
  request.token = Header(connection, "X-Hydroscope-Token");
  const std::string length = Header(connection, "Content-Length");
  std::from_chars(length.data(), length.data() + length.size(), request.length);
  return request;
}

MHD_Result Queue(MHD_Connection* connection, unsigned status, MHD_Response* response) {
  for (const auto& [name, value] : kHeaders) MHD_add_response_header(response, name, value);
  const MHD_Result queued = MHD_queue_response(connection, status, response);
  MHD_destroy_response(response);
  return queued;
}

MHD_Result Send(MHD_Connection* connection, const HttpReply& reply) {
  MHD_Response* response = MHD_create_response_from_buffer(
      reply.body.size(), const_cast<char*>(reply.body.data()), MHD_RESPMEM_MUST_COPY);
  MHD_add_response_header(response, "Content-Type", reply.type.c_str());
  if (reply.gzipped) MHD_add_response_header(response, "Content-Encoding", "gzip");
  MHD_add_response_header(response, "Cache-Control",
                          reply.stays ? "public, max-age=31536000, immutable" : "no-store");
  for (const auto& [name, value] : reply.headers)
    MHD_add_response_header(response, name.c_str(), value.c_str());
  return Queue(connection, reply.status, response);
}

ssize_t NextEvents(void* self, std::uint64_t, char* buffer, std::size_t most) {
  auto* stream = static_cast<EventStream*>(self);
  MHD_Connection* connection = stream->connection;
  const PortConnection* place = PlaceOf(connection);
  if ((place != nullptr && place->leaves) || !stream->hooks->may_listen_on(stream->request))
    return MHD_CONTENT_READER_END_OF_STREAM;
  const EventFeed::Piece piece = stream->hooks->events->Read(
      stream->position, most, [connection] { MHD_suspend_connection(connection); },
      [connection] { MHD_resume_connection(connection); });
  if (piece.ended) return MHD_CONTENT_READER_END_OF_STREAM;
  std::memcpy(buffer, piece.text.data(), piece.text.size());
  return static_cast<ssize_t>(piece.text.size());
}

MHD_Result SendEvents(MHD_Connection* connection, const HttpServer::Hooks& hooks, HttpRequest request) {
  if (PortConnection* place = PlaceOf(connection)) place->listens = true;
  auto* stream = new EventStream{&hooks, connection, std::move(request), hooks.events->end()};
  MHD_Response* response =
      MHD_create_response_from_callback(MHD_SIZE_UNKNOWN, kEventPiece, NextEvents, stream,
                                        [](void* done) { delete static_cast<EventStream*>(done); });
  MHD_add_response_header(response, "Content-Type", "text/event-stream");
  MHD_add_response_header(response, "Cache-Control", "no-store");
  return Queue(connection, MHD_HTTP_OK, response);
}

}  // namespace

namespace {

constexpr int kBacklog = 16;
/// Of GnuTLS: nothing older than TLS 1.2, and forward secrecy.
constexpr const char* kTlsPriorities = "SECURE128:-VERS-ALL:+VERS-TLS1.3:+VERS-TLS1.2:-RSA";

Result<sockaddr_storage> PlaceOf(const std::string& address, int port) {
  sockaddr_storage place{};
  auto* four = reinterpret_cast<sockaddr_in*>(&place);
  auto* six = reinterpret_cast<sockaddr_in6*>(&place);
  if (inet_pton(AF_INET, address.c_str(), &four->sin_addr) == 1) {
    four->sin_family = AF_INET;
    four->sin_port = htons(static_cast<std::uint16_t>(port));
    return place;
  }
  if (inet_pton(AF_INET6, address.c_str(), &six->sin6_addr) == 1) {
    six->sin6_family = AF_INET6;
    six->sin6_port = htons(static_cast<std::uint16_t>(port));
    return place;
  }
  return UsageError("'{}' is no address; expected one such as 127.0.0.1, 192.168.1.20, 0.0.0.0 or ::1",
                    address);
}

/// A bound stream socket at `path`; one that a dead program left behind is replaced.
Result<int> ListenAt(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.size() >= sizeof(address.sun_path))
    return UsageError("the path of the socket {} is longer than {} characters; use a shorter database path",
                      path, sizeof(address.sun_path) - 1);
  std::strcpy(address.sun_path, path.c_str());
  const auto* raw = reinterpret_cast<const sockaddr*>(&address);
  const int probe = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const bool alive = connect(probe, raw, sizeof(address)) == 0;
  close(probe);
  if (alive)
    return BadInput("{}: another service answers there already and writes this database; stop it first",
                    path);
  const int listener = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  unlink(path.c_str());
  if (bind(listener, raw, sizeof(address)) != 0 || listen(listener, kBacklog) != 0) {
    const std::string why = std::strerror(errno);
    close(listener);
    return InternalError("the socket {} cannot be made: {}", path, why);
  }
  return listener;
}

}  // namespace

/// What a daemon of the library answers at: the port or the socket.
struct HttpServer::Door {
  explicit Door(Hooks* to) : hooks(to) {}

  Hooks* hooks;
  std::optional<ConnectionPlaces> places;  ///< of the port
  MHD_Daemon* daemon = nullptr;

  bool of_socket() const { return !places; }
  /// `more`: what to listen at, and how, as options of libmicrohttpd.
  void Open(unsigned flags, std::vector<MHD_OptionItem> more) {
    more.push_back({MHD_OPTION_END, 0, nullptr});
    daemon = MHD_start_daemon(MHD_USE_EPOLL_INTERNAL_THREAD | MHD_ALLOW_SUSPEND_RESUME | flags, 0, nullptr,
                              nullptr, Handle, this, MHD_OPTION_ARRAY, more.data(),
                              MHD_OPTION_NOTIFY_COMPLETED, Forget, nullptr, MHD_OPTION_NOTIFY_CONNECTION,
                              ComesAndGoes, this, MHD_OPTION_CONNECTION_LIMIT, kMostConnections + kLeaving,
                              MHD_OPTION_CONNECTION_TIMEOUT, kIdle, MHD_OPTION_CONNECTION_MEMORY_LIMIT,
                              kMostHeaders, MHD_OPTION_END);
  }
  void Close() const {
    if (daemon != nullptr) MHD_stop_daemon(daemon);
  }

  static void ComesAndGoes(void* self, MHD_Connection* connection, void** context,
                           MHD_ConnectionNotificationCode what) {
    auto* door = static_cast<Door*>(self);
    if (door->of_socket()) return;
    if (what == MHD_CONNECTION_NOTIFY_STARTED) {
      auto* place = new PortConnection{&*door->places};
      *context = place;
      const int fd = MHD_get_connection_info(connection, MHD_CONNECTION_INFO_CONNECTION_FD)->connect_fd;
      place->id = door->places->Opened(AddressOf(connection), [door, place, fd] {
        place->leaves = true;
        shutdown(fd, SHUT_RDWR);  // the library sees it as soon as its other end had closed it ...
        if (place->listens) door->hooks->events->Wake();  // ... but of one that is suspended
      });
      return;
    }
    auto* place = static_cast<PortConnection*>(*context);
    door->places->Closed(place->id);
    delete place;
    *context = nullptr;
  }

  static MHD_Result Handle(void* self, MHD_Connection* connection, const char* url, const char* method,
                           const char*, const char* data, std::size_t* size, void** request) {
    auto* door = static_cast<Door*>(self);
    if (*request == nullptr) return door->Begin(connection, url, method, request);
    auto& open = *static_cast<OpenRequest*>(*request);
    if (*size > 0) return Take(open, data, size);
    return door->Finish(connection, open);
  }

  /// The head is there: refuses, or makes ready for the body.
  MHD_Result Begin(MHD_Connection* connection, const char* url, const char* method, void** request) const {
    HttpRequest head = HeadOf(connection, url, method);
    head.by_socket = of_socket();
    const auto refusal = head.by_socket ? std::nullopt : hooks->refuse(head);
    if (PortConnection* place = PlaceOf(connection)) place->Asked(head);
    if (refusal) return Send(connection, *refusal);
    auto* open = new OpenRequest{std::move(head)};
    *request = open;
    open->request.file = hooks->body_file(open->request);
    if (open->request.file.empty()) return MHD_YES;
    open->file.open(open->request.file, std::ios::binary);
    std::error_code ignored;  // has the size it will have, so that who comes meanwhile sees what room is left
    if (open->request.length > 0)
      std::filesystem::resize_file(open->request.file, static_cast<std::uintmax_t>(open->request.length),
                                   ignored);
    return MHD_YES;
  }

  /// A piece of the body; one that grows beyond its limit ends the connection.
  static MHD_Result Take(OpenRequest& open, const char* data, std::size_t* size) {
    open.received += static_cast<std::int64_t>(*size);
    if (open.received > BodyLimit(open.request.path)) return MHD_NO;
    if (open.request.file.empty())
      open.request.body.append(data, *size);
    else
      open.file.write(data, static_cast<std::streamsize>(*size));
    *size = 0;
    return MHD_YES;
  }

  MHD_Result Finish(MHD_Connection* connection, OpenRequest& open) const {
    if (open.file.is_open()) {
      open.file.close();
      if (!open.file)
        return Send(connection,
                    ErrorReply(507, Told("the upload cannot be stored: is the disk full?",
                                         "die Datei kann nicht abgelegt werden: ist die Platte voll?")));
    }
    if (open.request.path == hooks->event_path && open.request.method == "GET")
      return SendEvents(connection, *hooks, std::move(open.request));
    return Send(connection, hooks->answer(open.request));
  }

  static void Forget(void*, MHD_Connection* connection, void** request, MHD_RequestTerminationCode) {
    delete static_cast<OpenRequest*>(*request);
    *request = nullptr;
    if (const PortConnection* place = PlaceOf(connection)) place->Answered();
  }
};

struct HttpServer::Impl {
  Hooks hooks;
  HttpListen listen;
  Door of_port{&hooks}, of_socket{&hooks};
  int port = 0;
  std::string socket;
};

bool HttpListen::at_home() const { return address.starts_with("127.") || address == "::1"; }

HttpServer::HttpServer() : impl_(std::make_unique<Impl>()) {}

HttpServer::~HttpServer() {
  if (impl_->hooks.events != nullptr) impl_->hooks.events->Close();
  impl_->of_port.Close();
  impl_->of_socket.Close();
  if (!impl_->socket.empty()) unlink(impl_->socket.c_str());
}

int HttpServer::port() const { return impl_->port; }

Result<std::unique_ptr<HttpServer>> HttpServer::Open(const HttpListen& listen, Hooks hooks) {
  std::unique_ptr<HttpServer> server(new HttpServer);
  Impl& impl = *server->impl_;
  impl.hooks = std::move(hooks);
  impl.listen = listen;  // the library keeps pointers into it
  if (!listen.socket.empty()) {
    const auto listener = TRY(ListenAt(listen.socket));
    impl.of_socket.Open(0, {{MHD_OPTION_LISTEN_SOCKET, listener, nullptr}});
    if (impl.of_socket.daemon == nullptr)
      return InternalError("the socket {} cannot be served", listen.socket);
    impl.socket = listen.socket;
  }
  if (!listen.port) return server;
  auto place = TRY(PlaceOf(listen.address, *listen.port));
  unsigned flags = place.ss_family == AF_INET6 ? MHD_USE_IPv6 : 0;
  std::vector<MHD_OptionItem> options = {{MHD_OPTION_SOCK_ADDR, 0, &place}};
  if (!listen.certificate.empty()) {
    flags |= MHD_USE_TLS;
    options.push_back({MHD_OPTION_HTTPS_MEM_CERT, 0, impl.listen.certificate.data()});
    options.push_back({MHD_OPTION_HTTPS_MEM_KEY, 0, impl.listen.key.data()});
    options.push_back({MHD_OPTION_HTTPS_PRIORITIES, 0, const_cast<char*>(kTlsPriorities)});
  }
  impl.of_port.places.emplace(
      ConnectionPlaces::Limits{kMostConnections, listen.at_home() ? kMostConnections : kMostOfOneAddress});
  errno = 0;
  impl.of_port.Open(flags, std::move(options));
  MHD_Daemon* daemon = impl.of_port.daemon;
  if (daemon == nullptr && errno == 0 && !listen.certificate.empty())
    return BadInput("the certificate of the page and its key are no pair of PEM files");
  if (daemon == nullptr)
    return BadInput("port {} on {} cannot be opened ({}); give another one with --port, or 0 for any",
                    *listen.port, listen.address, std::strerror(errno));
  const auto* info = MHD_get_daemon_info(daemon, MHD_DAEMON_INFO_BIND_PORT);
  impl.port = info == nullptr ? *listen.port : info->port;
  return server;
}

}  // namespace hydroscope
