#include <arpa/inet.h>
#include <fcntl.h>
#include <linux/if_tun.h>
#include <net/if.h>
#include <poll.h>
#include <sched.h>
#include <signal.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <functional>
#include <memory>
#include <mutex>
#include <random>
#include <thread>
#include <vector>

#include "core/result.h"
#include "host/output.h"
#include "studies/fault_table.h"
#include "studies/live/live_benchmarks.h"

namespace hydroscope {
namespace {

/// What a wire does to each frame, in both directions.
struct Impairment {
  double loss = 0;        ///< share of the frames
  double delay = 0;       ///< s
  double overtaking = 0;  ///< share of the frames that go without the delay, and so before earlier ones
  bool cut = false;       ///< nothing passes
};

/// Two network namespaces, each with one card at the end of a wire that this process is: it reads frames from
/// one card (a TAP device) and hands them to the other one, or not. In place of the kernel's netem, which is
/// not in every kernel; and the same seed loses the same frames. Namespaces and cards go with the object.
class ImpairedWire {
 public:
  static constexpr const char* kAddresses[2] = {"10.77.0.1", "10.77.0.2"};

  /// Call it before any thread is started: without the right to make network namespaces it makes a user
  /// namespace of its own. Errors say what is not allowed here.
  static Result<std::unique_ptr<ImpairedWire>> Create(std::uint64_t seed);
  ~ImpairedWire();
  ImpairedWire(const ImpairedWire&) = delete;
  ImpairedWire& operator=(const ImpairedWire&) = delete;

  /// File of the namespace of an end (0 or 1), for setns.
  int network(int end) const { return ends_[end].network; }
  void Set(const Impairment& impairment);
  std::int64_t carried() const { return carried_; }
  std::int64_t lost() const { return lost_; }

 private:
  struct End {
    int card = -1, network = -1;
  };
  struct Frame {
    std::int64_t due = 0;  ///< ns, monotonic
    std::uint64_t number = 0;
    int to = 0;
    std::vector<std::uint8_t> bytes;
    bool operator>(const Frame& other) const {
      return due != other.due ? due > other.due : number > other.number;
    }
  };
  explicit ImpairedWire(std::uint64_t seed) : random_(seed) {}
  static Status OpenEnd(const char* address, End& end);
  void Run(const std::stop_token& stop);
  void Receive(int from, std::vector<Frame>& waiting);

  End ends_[2];
  std::mutex mutex_;
  Impairment impairment_;
  std::mt19937_64 random_;
  std::uint64_t number_ = 0;
  std::atomic<std::int64_t> carried_ = 0, lost_ = 0;
  std::jthread thread_;
};

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

constexpr double kImpaired = 20.0;  // s that the wire stays impaired

/// The wire is bad for a while: no row may be missing, and the service must go on.
void Impair(LiveRig& rig, ImpairedWire& wire, FaultTable& table, const char* what,
            const Impairment& impairment) {
  const auto before = rig.Ask();
  wire.Set(impairment);
  Sleep(kImpaired);
  const auto after = rig.Ask();
  wire.Set({});
  if (!before || !after) return table.Row(what, {}, {}, false, "the service does not answer");
  const auto passed = [&](const char* counter) {
    return SumOverAxes(*after, counter) - SumOverAxes(*before, counter);
  };
  const std::int64_t missing = passed("missing_rows") + passed("skipped_rows");
  table.Row(what, {}, {}, missing == 0 && passed("rows") > 0,
            fmt::format("{} rows, {} missing", passed("rows"), missing));
  Sleep(2);
}

}  // namespace

int RunLiveNetwork(const LiveNetworkOptions& o) {
  const auto wire = ImpairedWire::Create(o.seed);
  if (!wire) {
    fmt::print("not tried: {}\n", wire.error().text);
    return 0;
  }
  LiveRig rig({.seed = o.seed,
               .transport = "udp",
               .folder = {},
               .press_address = ImpairedWire::kAddresses[0],
               .service_address = ImpairedWire::kAddresses[1],
               .press_network = (*wire)->network(0),
               .service_network = (*wire)->network(1)});
  if (const Status begun = rig.Begin(); !begun) return ReportError(begun.error());
  FaultTable table(rig);
  Impair(rig, **wire, table, "5 % of the frames lost", {.loss = 0.05});
  Impair(rig, **wire, table, "50 ms delay, a quarter overtakes", {.delay = 0.05, .overtaking = 0.25});
  Impair(rig, **wire, table, "all of that", {.loss = 0.05, .delay = 0.05, .overtaking = 0.25});
  const auto cut = [&] { (*wire)->Set({.cut = true}); };
  const auto join = [&] { (*wire)->Set({}); };
  for (const double seconds : {5.0, o.cut}) {
    table.Cut(fmt::format("wire cut for {:g} s (DDS)", seconds), "p_A", seconds, cut, join);
    table.Cut(fmt::format("wire cut for {:g} s (Modbus)", seconds), "T_oil", seconds, cut, join);
  }
  const auto last = rig.Ask();
  const int ended = rig.service().End(SIGTERM);
  fmt::print("frames carried {}, lost {}; rows missing in all {}\n", (*wire)->carried(), (*wire)->lost(),
             last ? SumOverAxes(*last, "missing_rows") : -1);
  const auto same = ReplaysAreTheSame(rig.database(), ended);
  if (!same) return ReportError(same.error());
  return table.missed() == 0 && *same && ended == 0 ? 0 : 1;
}

}  // namespace hydroscope
