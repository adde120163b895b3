#include "alarms/feeds/modbus/listener.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <thread>

namespace hydroscope {
namespace {

constexpr std::int64_t kMillisecond = 1'000'000;                 // ns
constexpr std::int64_t kHalfRequestAllowed = 40 * kMillisecond;  // from its first byte
constexpr std::int64_t kPauseAfterFailure = 100 * kMillisecond;  // of accept(): no descriptors left
constexpr std::int64_t kLongestWait = 1000 * kMillisecond;
constexpr std::int64_t kIdleGivesWay = 1000 * kMillisecond;  // a poller asks once a second or more often
constexpr int kWaitingConnections = 64;

/// Closes what it holds.
class Descriptor {
 public:
  explicit Descriptor(int fd) : fd_(fd) {}
  Descriptor(Descriptor&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(fd_, other.fd_);
    return *this;
  }
  ~Descriptor() {
    if (fd_ >= 0) close(fd_);
  }
  int get() const { return fd_; }

 private:
  int fd_;
};

struct Client {
  Descriptor socket;
  std::string address;
  ModbusConversation conversation;
  std::int64_t last_request = 0;  // ns, monotonic; before the first one, since when it is connected
  bool asked = false;             // for something sound, ever
  std::int64_t half_since = 0;    // first byte of a request that is not complete; 0: none
  bool over = false;
};

class Listener : public ModbusListener {
 public:
  Listener(const ModbusFeedSpec& spec, Descriptor socket, Descriptor wake, int port, WithRegisters registers,
           Clock clock)
      : most_(static_cast<std::size_t>(spec.connections)),
        idle_(static_cast<std::int64_t>(std::min(spec.idle_timeout, 1e6) * 1e9)),
        socket_(std::move(socket)),
        wake_(std::move(wake)),
        port_(port),
        registers_(std::move(registers)),
        clock_(std::move(clock)) {
    for (const std::string& client : spec.allow) allow_.push_back(*ParseIpv4Range(client));
    thread_ = std::jthread([this](std::stop_token stop) { Serve(stop); });
  }
  ~Listener() override {
    thread_.request_stop();
    const std::uint64_t one = 1;
    static_cast<void>(!write(wake_.get(), &one, sizeof one));
  }

  int port() const override { return port_; }
  Counters counters() const override {
    std::lock_guard lock(mutex_);
    return {client_count_, accepted_, refused_, gave_way_, malformed_, refusal_};
  }

 private:
  void Serve(const std::stop_token& stop) {
    std::vector<pollfd> waiting;
    std::int64_t accept_after = 0;
    while (!stop.stop_requested()) {
      std::int64_t now = clock_().monotonic_ns;
      waiting.assign({{wake_.get(), POLLIN, 0}, {socket_.get(), POLLIN, 0}});
      if (now < accept_after) waiting[1].fd = -1;
      for (const Client& client : clients_) waiting.push_back({client.socket.get(), POLLIN, 0});
      const std::int64_t until = NextDeadline(now, accept_after);
      if (poll(waiting.data(), waiting.size(), static_cast<int>((until - now) / kMillisecond + 1)) < 0)
        continue;
      now = clock_().monotonic_ns;
      for (std::size_t k = 0; k < clients_.size(); ++k)
        if (waiting[k + 2].revents != 0) Hear(clients_[k], now);
      DropLate(now);
      if (waiting[1].revents != 0 && !Accept(now)) accept_after = now + kPauseAfterFailure;
      client_count_ = static_cast<int>(clients_.size());
    }
  }

  std::int64_t NextDeadline(std::int64_t now, std::int64_t accept_after) const {
    std::int64_t next = now + kLongestWait;
    if (accept_after > now) next = std::min(next, accept_after);
    for (const Client& client : clients_) {
      next = std::min(next, client.last_request + idle_);
      if (client.half_since != 0) next = std::min(next, client.half_since + kHalfRequestAllowed);
    }
    return std::max(next, now);
  }

  /// False: the system gives no connection although one is waiting.
  bool Accept(std::int64_t now) {
    sockaddr_in from{};
    socklen_t size = sizeof from;
    Descriptor socket(
        accept4(socket_.get(), reinterpret_cast<sockaddr*>(&from), &size, SOCK_NONBLOCK | SOCK_CLOEXEC));
    if (socket.get() < 0) return errno == EAGAIN || errno == ECONNABORTED || errno == EINTR;
    const std::uint32_t address = ntohl(from.sin_addr.s_addr);
    char text[INET_ADDRSTRLEN] = "";
    inet_ntop(AF_INET, &from.sin_addr, text, sizeof text);
    const bool allowed =
        std::ranges::any_of(allow_, [&](const Ipv4Range& range) { return range.Contains(address); });
    if (!allowed) {
      Count(refused_, text, "is not among [feeds.modbus] allow");
      return true;
    }
    if (clients_.size() >= most_ && !EndTheMostIdle(now)) {
      Count(refused_, text, "found all [feeds.modbus] connections taken");
      return true;
    }
    const int on = 1;
    setsockopt(socket.get(), IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    clients_.push_back({std::move(socket), text, {}, now, false});
    ++accepted_;
    return true;
  }

  /// False: all of them ask for something now and then. Who never did goes first.
  bool EndTheMostIdle(std::int64_t now) {
    const auto idlest = std::ranges::min_element(clients_, [](const Client& a, const Client& b) {
      return std::pair(a.asked, a.last_request) < std::pair(b.asked, b.last_request);
    });
    if (now - idlest->last_request < (idlest->asked ? kIdleGivesWay : kHalfRequestAllowed)) return false;
    clients_.erase(idlest);
    ++gave_way_;
    return true;
  }

  void Hear(Client& client, std::int64_t now) {
    std::array<std::uint8_t, 4 * ModbusConversation::kLongestFrame> bytes;
    const ssize_t got = recv(client.socket.get(), bytes.data(), bytes.size(), 0);
    if (got <= 0) {
      client.over = got == 0 || (errno != EAGAIN && errno != EINTR);
      return;
    }
    answers_.clear();
    bool sound = false;
    registers_(client.address, [&](const ModbusRegisters& registers) {
      sound = client.conversation.Receive(std::span(bytes).first(static_cast<std::size_t>(got)), registers,
                                          answers_);
    });
    if (!answers_.empty()) {
      client.last_request = now;
      client.asked = true;
    }
    if (!client.conversation.halfway())
      client.half_since = 0;
    else if (client.half_since == 0 || !answers_.empty())
      client.half_since = now;
    const bool sent = answers_.empty() || send(client.socket.get(), answers_.data(), answers_.size(),
                                               MSG_NOSIGNAL) == static_cast<ssize_t>(answers_.size());
    if (sound && sent) return;
    client.over = true;
    Count(malformed_, client.address, sound ? "does not read its answers" : "sent what is no Modbus");
  }

  void Count(std::atomic<std::int64_t>& counter, const std::string& address, const char* why) {
    ++counter;
    std::lock_guard lock(mutex_);
    refusal_ = address + " " + why;
  }

  void DropLate(std::int64_t now) {
    std::erase_if(clients_, [&](const Client& client) {
      const bool half = client.half_since != 0 && now - client.half_since >= kHalfRequestAllowed;
      if (half && !client.over) Count(malformed_, client.address, "did not end its request");
      return client.over || half || now - client.last_request >= idle_;
    });
  }

  std::size_t most_;
  std::int64_t idle_;  // ns
  std::vector<Ipv4Range> allow_;
  Descriptor socket_, wake_;
  int port_;
  WithRegisters registers_;
  Clock clock_;
  std::vector<Client> clients_;
  std::vector<std::uint8_t> answers_;
  std::atomic<int> client_count_ = 0;
  std::atomic<std::int64_t> accepted_ = 0, refused_ = 0, gave_way_ = 0, malformed_ = 0;
  mutable std::mutex mutex_;
  std::string refusal_;  // guarded
  std::jthread thread_;
};

int PortOf(int socket) {
  sockaddr_in address{};
  socklen_t size = sizeof address;
  getsockname(socket, reinterpret_cast<sockaddr*>(&address), &size);
  return ntohs(address.sin_port);
}

}  // namespace

Result<std::unique_ptr<ModbusListener>> ModbusListener::Open(const ModbusFeedSpec& spec,
                                                             WithRegisters registers, Clock clock) {
  Descriptor listening(socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  Descriptor wake(eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC));
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(spec.port));
  inet_pton(AF_INET, spec.host.c_str(), &address.sin_addr);
  const int on = 1;
  setsockopt(listening.get(), SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  if (listening.get() < 0 || wake.get() < 0 ||
      bind(listening.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 ||
      listen(listening.get(), kWaitingConnections) != 0)
    return BadInput(
        "[feeds.modbus] {}:{} cannot be opened: {}; expected an address of this computer and a free port",
        spec.host, spec.port, std::strerror(errno));
  const int port = PortOf(listening.get());
  return std::make_unique<Listener>(spec, std::move(listening), std::move(wake), port, std::move(registers),
                                    std::move(clock));
}

}  // namespace hydroscope
