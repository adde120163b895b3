// Event streams of the page by libmicrohttpd (page/http/http_server.h) beside the same by Boost.Beast, in one run: 200 readers, 50 of
// which read nothing, and a client that keeps asking for something else. Each server is a process of its own with one thread
// for all connections and the same bounded feed (page/http/event_feed.h).
//   event_streams_bench [SECONDS [RUNS]]    default 10 s each, 3 times in turn
#include <fmt/format.h>
#include <sys/epoll.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <boost/asio.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/version.hpp>
#include <charconv>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <thread>
#include <vector>

#include "page/http/event_feed.h"
#include "page/http/http_server.h"

namespace hydroscope {
namespace {

namespace asio = boost::asio;
namespace http = boost::beast::http;
using Tcp = asio::ip::tcp;

constexpr int kStreams = 200, kStalled = 50;
constexpr std::chrono::milliseconds kBetweenEvents{20};
constexpr std::size_t kEventBytes = 1000, kReplyBytes = 2000;
constexpr std::size_t kPiece = 4096;  ///< bytes of a stream handed over at a time, as the page does
constexpr const char* kEventPath = "/api/v1/events";

double Now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// The page's server.
std::unique_ptr<HttpServer> OpenMicrohttpd(EventFeed& feed) {
  HttpServer::Hooks hooks;
  hooks.refuse = [](HttpRequest&) { return std::nullopt; };
  hooks.body_file = [](const HttpRequest&) { return std::string(); };
  hooks.answer = [](const HttpRequest&) {
    HttpReply reply;
    reply.body.assign(kReplyBytes, 'x');
    return reply;
  };
  hooks.event_path = kEventPath;
  hooks.events = &feed;
  hooks.may_listen_on = [](const HttpRequest&) { return true; };
  HttpListen listen;
  listen.port = 0;
  auto server = HttpServer::Open(listen, std::move(hooks));
  return server ? std::move(*server) : nullptr;
}

/// The same by Beast, one coroutine a connection.
class BeastServer {
 public:
  explicit BeastServer(EventFeed& feed) : feed_(feed) {
    asio::co_spawn(context_, Accept(), asio::detached);
    thread_ = std::thread([this] { context_.run(); });
  }
  ~BeastServer() {
    context_.stop();
    thread_.join();
  }
  int port() const { return acceptor_.local_endpoint().port(); }

 private:
  asio::awaitable<void> Accept() {
    for (;;) {
      Tcp::socket socket = co_await acceptor_.async_accept(asio::use_awaitable);
      asio::co_spawn(context_, Serve(std::move(socket)), asio::detached);
    }
  }

  asio::awaitable<void> Serve(Tcp::socket socket) {
    boost::beast::flat_buffer buffer;
    for (;;) {
      http::request<http::string_body> request;
      co_await http::async_read(socket, buffer, request, asio::use_awaitable);
      if (request.target() == kEventPath) co_await Stream(socket);
      http::response<http::string_body> reply(http::status::ok, request.version());
      reply.set(http::field::content_type, "application/json");
      reply.body().assign(kReplyBytes, 'x');
      reply.prepare_payload();
      co_await http::async_write(socket, reply, asio::use_awaitable);
    }
  }

  /// Ends when the reader is gone, by the exception of a write.
  asio::awaitable<void> Stream(Tcp::socket& socket) {
    http::response<http::empty_body> head(http::status::ok, 11);
    head.set(http::field::content_type, "text/event-stream");
    head.chunked(true);
    http::response_serializer<http::empty_body> serializer(head);
    co_await http::async_write_header(socket, serializer, asio::use_awaitable);
    std::uint64_t position = feed_.end();
    // A timer that never ends stands for "nothing to say"; to cancel it is to wake the stream.
    const auto waiting = std::make_shared<asio::steady_timer>(context_);
    for (;;) {
      const EventFeed::Piece piece = feed_.Read(
          position, kPiece, [&] { waiting->expires_at(asio::steady_timer::time_point::max()); },
          [this, waiting] { asio::post(context_, [waiting] { waiting->cancel(); }); });
      if (piece.ended) co_return;
      boost::system::error_code woken;
      if (piece.text.empty())
        co_await waiting->async_wait(asio::redirect_error(asio::use_awaitable, woken));
      else
        co_await asio::async_write(socket, http::make_chunk(asio::buffer(piece.text)), asio::use_awaitable);
    }
  }

  EventFeed& feed_;
  asio::io_context context_{1};
  Tcp::acceptor acceptor_{context_, Tcp::endpoint(asio::ip::address_v4::loopback(), 0)};
  std::thread thread_;
};

/// In the process of its own: tells its port by `told`, then publishes events that begin with their time until it is stopped.
template <typename Server>
void PublishForEver(EventFeed& feed, const Server& server, int told) {
  const int port = server.port();
  if (write(told, &port, sizeof(port)) != sizeof(port)) _exit(1);
  for (;;) {
    std::string event = fmt::format("{:.9f} ", Now());
    event.resize(kEventBytes, '.');
    feed.Publish(event);
    std::this_thread::sleep_for(kBetweenEvents);
  }
}

int Connect(int port) {
  const int to = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in place{};
  place.sin_family = AF_INET;
  place.sin_port = htons(static_cast<std::uint16_t>(port));
  place.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (connect(to, reinterpret_cast<const sockaddr*>(&place), sizeof(place)) != 0) return -1;
  return to;
}

void Ask(int to, const char* path) {
  const std::string request = fmt::format("GET {} HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n", path);
  if (write(to, request.data(), request.size()) < 0) std::exit(1);
}

/// Delays of the events that arrived in a piece of a stream; those that are cut by its ends are left out.
void TakeDelays(std::string_view piece, std::vector<double>& delays) {
  constexpr std::string_view kMark = "data: ";
  const double now = Now();
  for (std::size_t at = 0; (at = piece.find(kMark, at)) != std::string_view::npos;) {
    at += kMark.size();
    double sent = 0;
    const auto [end, error] = std::from_chars(piece.data() + at, piece.data() + piece.size(), sent);
    if (error == std::errc() && end != piece.data() + piece.size()) delays.push_back(now - sent);
  }
}

struct Measured {
  std::vector<double> delays, requests;  ///< s, sorted
  double megabytes = 0, cpu = 0;         ///< of the server: memory at the end; CPU seconds per second
};

double Share(const std::vector<double>& sorted, double share) {
  return sorted.empty() ? NAN
                        : sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))];
}

double Megabytes(pid_t process) {
  std::ifstream statm(fmt::format("/proc/{}/statm", process));
  double all = 0, resident = 0;
  statm >> all >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE)) / 1e6;
}

double CpuOfChildren() {
  rusage used{};
  getrusage(RUSAGE_CHILDREN, &used);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(used.ru_utime) + seconds(used.ru_stime);
}

/// 150 streams that read, 50 that do not, and one request after another.
Measured Load(int port, double seconds) {
  Measured measured;
  const int poll = epoll_create1(EPOLL_CLOEXEC);
  std::vector<int> all;
  for (int k = 0; k < kStreams; ++k) {
    all.push_back(Connect(port));
    Ask(all.back(), kEventPath);
    epoll_event event{EPOLLIN, {.fd = all.back()}};
    if (k >= kStalled) epoll_ctl(poll, EPOLL_CTL_ADD, all.back(), &event);
  }
  const int asker = Connect(port);
  all.push_back(asker);
  epoll_event event{EPOLLIN, {.fd = asker}};
  epoll_ctl(poll, EPOLL_CTL_ADD, asker, &event);
  std::array<char, 64 * 1024> piece;
  std::array<epoll_event, kStreams> ready;
  const double end = Now() + seconds;
  double asked = Now();
  std::size_t received = 0;
  Ask(asker, "/api/v1/session");
  while (Now() < end) {
    const int count = epoll_wait(poll, ready.data(), static_cast<int>(ready.size()), 100);
    for (int k = 0; k < count; ++k) {
      const int from = ready[static_cast<std::size_t>(k)].data.fd;
      const ssize_t size = read(from, piece.data(), piece.size());
      if (size <= 0) {
        fmt::print(stderr, "event_streams_bench: a connection ended\n");
        std::exit(1);
      }
      if (from != asker) {
        TakeDelays({piece.data(), static_cast<std::size_t>(size)}, measured.delays);
        continue;
      }
      received += static_cast<std::size_t>(size);
      if (received < kReplyBytes) continue;
      measured.requests.push_back(Now() - asked);
      received = 0;
      asked = Now();
      Ask(asker, "/api/v1/session");
    }
  }
  for (const int socket : all) close(socket);
  close(poll);
  std::sort(measured.delays.begin(), measured.delays.end());
  std::sort(measured.requests.begin(), measured.requests.end());
  return measured;
}

Measured Measure(bool beast, double seconds) {
  int told[2];
  if (pipe(told) != 0) std::exit(1);
  const double before = CpuOfChildren();
  const pid_t server = fork();
  if (server == 0) {
    EventFeed feed;
    if (beast)
      PublishForEver(feed, BeastServer(feed), told[1]);
    else if (const auto microhttpd = OpenMicrohttpd(feed))
      PublishForEver(feed, *microhttpd, told[1]);
    _exit(1);
  }
  close(told[1]);
  int port = 0;
  if (read(told[0], &port, sizeof(port)) != sizeof(port)) {
    fmt::print(stderr, "event_streams_bench: the server did not start\n");
    std::exit(1);
  }
  close(told[0]);
  Measured measured = Load(port, seconds);
  measured.megabytes = Megabytes(server);
  kill(server, SIGKILL);
  waitpid(server, nullptr, 0);
  measured.cpu = (CpuOfChildren() - before) / seconds;
  return measured;
}

int Run(double seconds, int runs) {
  fmt::print("{} streams, {} of which read nothing; an event of {} bytes each {} ms; {:.0f} s a run\n",
             kStreams, kStalled, kEventBytes, kBetweenEvents.count(), seconds);
  fmt::print("{:<22} {:>9} {:>9} {:>9} {:>11} {:>11} {:>9} {:>7}\n", "server", "event p50", "p99", "at most",
             "request p50", "p99", "memory", "CPU");
  for (int run = 0; run < runs; ++run)
    for (const bool beast : {false, true}) {
      const Measured m = Measure(beast, seconds);
      const std::string name =
          beast ? fmt::format("Boost.Beast {}.{}", BOOST_VERSION / 100000, BOOST_VERSION / 100 % 1000)
                : std::string("libmicrohttpd (ours)");
      fmt::print(
          "{:<22} {:>6.2f} ms {:>6.2f} ms {:>6.1f} ms {:>8.2f} ms {:>8.2f} ms {:>6.1f} MB {:>5.1f} %\n", name,
          1e3 * Share(m.delays, 0.5), 1e3 * Share(m.delays, 0.99), 1e3 * Share(m.delays, 1),
          1e3 * Share(m.requests, 0.5), 1e3 * Share(m.requests, 0.99), m.megabytes, 100 * m.cpu);
    }
  return 0;
}

}  // namespace
}  // namespace hydroscope

int main(int argc, char** argv) {
  return hydroscope::Run(argc > 1 ? std::atof(argv[1]) : 10, argc > 2 ? std::atoi(argv[2]) : 3);
}
