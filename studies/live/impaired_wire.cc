#include "studies/live/impaired_wire.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <linux/if_tun.h>
#include <net/if.h>
#include <poll.h>
#include <sched.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <fstream>
#include <functional>

namespace hydroscope {
namespace {

constexpr std::size_t kLargestFrame = 2048;

std::int64_t NowNs() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

Error Refused(const char* what) {
  return {ErrorKind::kBadInput, fmt::format("{}: {}", what, std::strerror(errno))};
}

/// Root in a user namespace of its own, if this process may not make network namespaces as it is.
Status GainNetworkRights() {
  if (geteuid() == 0) return {};
  const auto user = geteuid();
  const auto group = getegid();
  if (unshare(CLONE_NEWUSER) != 0) return tl::unexpected(Refused("a user namespace is not allowed here"));
  std::ofstream("/proc/self/setgroups") << "deny";
  std::ofstream("/proc/self/uid_map") << "0 " << user << " 1";
  std::ofstream("/proc/self/gid_map") << "0 " << group << " 1";
  return {};
}

bool SwitchOn(int socket, ifreq& request) {
  if (ioctl(socket, SIOCGIFFLAGS, &request) != 0) return false;
  request.ifr_flags = static_cast<short>(request.ifr_flags | IFF_UP | IFF_RUNNING);
  return ioctl(socket, SIOCSIFFLAGS, &request) == 0;
}

bool SetAddress(int socket, const char* card, const char* address) {
  ifreq request{};
  std::strncpy(request.ifr_name, card, IFNAMSIZ - 1);
  sockaddr_in internet{};
  internet.sin_family = AF_INET;
  const auto set = [&](unsigned long what, const char* text) {
    inet_pton(AF_INET, text, &internet.sin_addr);
    std::memcpy(&request.ifr_addr, &internet, sizeof(internet));
    return ioctl(socket, what, &request) == 0;
  };
  return set(SIOCSIFADDR, address) && set(SIOCSIFNETMASK, "255.255.255.0") && SwitchOn(socket, request);
}

}  // namespace

/// Moves the calling thread into a network namespace of its own and gives it a card.
Status ImpairedWire::OpenEnd(const char* address, End& end) {
  constexpr char kCard[] = "wire0";
  if (unshare(CLONE_NEWNET) != 0) return tl::unexpected(Refused("a network namespace is not allowed here"));
  end.network = open("/proc/thread-self/ns/net", O_RDONLY | O_CLOEXEC);
  end.card = open("/dev/net/tun", O_RDWR | O_NONBLOCK | O_CLOEXEC);
  if (end.card < 0) return tl::unexpected(Refused("/dev/net/tun cannot be opened"));
  ifreq request{};
  std::strncpy(request.ifr_name, kCard, IFNAMSIZ - 1);
  request.ifr_flags = IFF_TAP | IFF_NO_PI;
  if (ioctl(end.card, TUNSETIFF, &request) != 0)
    return tl::unexpected(Refused("a TAP device is not allowed here"));
  const int control = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  ifreq loopback{};
  std::strncpy(loopback.ifr_name, "lo", IFNAMSIZ - 1);
  const bool up = SwitchOn(control, loopback) && SetAddress(control, kCard, address);
  close(control);
  if (!up) return tl::unexpected(Refused("a network card cannot be set up"));
  return {};
}

Result<std::unique_ptr<ImpairedWire>> ImpairedWire::Create(std::uint64_t seed) {
  TRY(GainNetworkRights());
  std::unique_ptr<ImpairedWire> wire(new ImpairedWire(seed));
  for (int e = 0; e < 2; ++e) {
    Status opened;
    std::thread([&] { opened = OpenEnd(kAddresses[e], wire->ends_[e]); }).join();
    if (!opened) return tl::unexpected(opened.error());
  }
  wire->thread_ = std::jthread([w = wire.get()](std::stop_token stop) { w->Run(stop); });
  return wire;
}

ImpairedWire::~ImpairedWire() {
  thread_ = {};
  for (const End& end : ends_)
    for (const int file : {end.card, end.network})
      if (file >= 0) close(file);
}

void ImpairedWire::Set(const Impairment& impairment) {
  std::lock_guard lock(mutex_);
  impairment_ = impairment;
}

void ImpairedWire::Run(const std::stop_token& stop) {
  std::vector<Frame> waiting;  // a heap, the earliest in front
  while (!stop.stop_requested()) {
    pollfd files[2] = {{ends_[0].card, POLLIN, 0}, {ends_[1].card, POLLIN, 0}};
    timespec patience{0, 20'000'000};
    if (!waiting.empty())
      patience.tv_nsec = std::clamp<std::int64_t>(waiting.front().due - NowNs(), 0, patience.tv_nsec);
    ppoll(files, 2, &patience, nullptr);
    for (int from = 0; from < 2; ++from) Receive(from, waiting);
    while (!waiting.empty() && waiting.front().due <= NowNs()) {
      std::pop_heap(waiting.begin(), waiting.end(), std::greater<>());
      const Frame& frame = waiting.back();
      carried_ += write(ends_[frame.to].card, frame.bytes.data(), frame.bytes.size()) > 0;
      waiting.pop_back();
    }
  }
}

/// Takes what the card has sent and decides what becomes of it.
void ImpairedWire::Receive(int from, std::vector<Frame>& waiting) {
  std::uint8_t bytes[kLargestFrame];
  std::uniform_real_distribution<double> chance(0, 1);
  for (ssize_t size = 0; (size = read(ends_[from].card, bytes, sizeof(bytes))) > 0;) {
    Impairment now;
    {
      std::lock_guard lock(mutex_);
      now = impairment_;
    }
    if (now.cut || chance(random_) < now.loss) {
      ++lost_;
      continue;
    }
    const double delay = chance(random_) < now.overtaking ? 0 : now.delay;
    waiting.push_back({NowNs() + static_cast<std::int64_t>(delay * 1e9), ++number_, 1 - from,
                       std::vector<std::uint8_t>(bytes, bytes + size)});
    std::push_heap(waiting.begin(), waiting.end(), std::greater<>());
  }
}

}  // namespace hydroscope
