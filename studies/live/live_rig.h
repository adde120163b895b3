#pragma once

#include <signal.h>
#include <sys/types.h>

#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/result.h"

namespace hydroscope {

/// A child of this very program, or of another one, killed with its object.
class Child {
 public:
  using Environment = std::vector<std::pair<std::string, std::string>>;
  /// `arguments` of hydroscope; standard output and error go to `log`. `network`: file of the network
  /// namespace it shall live in, -1 for that of its parent.
  Child(const std::vector<std::string>& arguments, const std::string& log, int network = -1,
        const std::string& program = "/proc/self/exe", const Environment& environment = {});
  ~Child();
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  /// A line on its standard input.
  void Say(const std::string& line) const;
  void Signal(int signal) const;
  /// Sends the signal and waits for the end: exit code, or 128 + signal.
  int End(int signal);
  bool Alive() const;
  pid_t pid() const { return pid_; }
  /// -20, first, to 19, last. A user who may not leaves it as it is.
  void SetNice(int nice) const;

 private:
  pid_t pid_ = -1;
  int input_ = -1;
};

struct RigOptions {
  int axes = 4;
  double rate = 1000;        ///< Hz
  bool modbus_ring = false;  ///< all by Modbus in place of DDS (at most 8 axes)
  std::uint64_t seed = 1;
  std::string transport = "default";  ///< of DDS
  double clock_drift = 0;             ///< ppm
  int adc_bits = 16;                  ///< of the press's converters; 0 = none
  std::string folder;                 ///< "" = a temporary one, removed at the end
  std::string press_address = "127.0.0.1", service_address = "127.0.0.1";
  int press_network = -1, service_network = -1;  ///< namespaces, see Child
  int nice = -15;  ///< of service and press, as far as the user may: that of live/systemd/hydroscope@.service
  std::string feeds = "";  ///< [feeds...] of the service's machine file
};

/// A simulated press and a service that watches it, each a process of its own, on the loopback unless told otherwise.
class LiveRig {
 public:
  explicit LiveRig(const RigOptions& options);
  ~LiveRig();

  std::string File(const std::string& name) const { return folder_ + "/" + name; }
  std::string database() const { return File("press.db"); }
  void StartPress();
  void StartService(std::vector<std::string> more = {});
  /// Starts both and waits for the first stroke; an error if none is stored within 60 s.
  Status Begin(std::vector<std::string> more = {});
  /// Another press that sends the same channels, until StopRival.
  void StartRival();
  void StopRival() { rival_->End(SIGTERM); }
  /// [feeds...] of services started from now on.
  void SetFeeds(const std::string& feeds);
  /// Ends press and service and starts both again, with another transport and in other environments.
  void StartAgain(const std::string& transport, Child::Environment press, Child::Environment service);
  /// Of the samples.
  int domain() const { return domain_; }
  /// Last lines of what press and service wrote, for a message that says why nothing comes.
  std::string LastWords() const;
  /// Niceness that the service got.
  int nice() const;
  Child& press() { return *press_; }
  Child& service() { return *service_; }
  void KillPress() { press_.reset(); }
  /// What the service says; nullopt if it does not answer.
  std::optional<nlohmann::json> Ask() const;
  /// Waits until the condition holds of what the service says; s until that was asked, or nullopt after
  /// `limit` s.
  std::optional<double> WaitFor(const std::function<bool(const nlohmann::json&)>& condition,
                                double limit) const;

 private:
  void WriteMachines();

  RigOptions options_;
  std::string folder_, feeds_;
  bool temporary_ = false;
  int domain_ = 0, port_ = 0;
  Child::Environment press_environment_, service_environment_;
  std::unique_ptr<Child> press_, service_, rival_;
};

void Sleep(double seconds);
double Now();  ///< s, monotonic

}  // namespace hydroscope
