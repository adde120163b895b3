#pragma once

#include <deque>
#include <map>
#include <string>

namespace hydroscope {

/// Makes guessing passwords slow: who failed too often waits. Times are arguments, s of a clock that only goes forward.
class LoginLimiter {
 public:
  struct Options {
    double window = 15 * 60;         ///< s that a failure is remembered
    std::size_t of_name = 5;         ///< failures of one name from one address within the window
    std::size_t of_address = 20;     ///< and of one address with any name
    std::size_t remembered = 10000;  ///< names and addresses at most: beyond, everybody waits
  };
  LoginLimiter() : LoginLimiter(Options{}) {}
  explicit LoginLimiter(Options options) : options_(options) {}

  /// s until another attempt is looked at; 0: now.
  double Wait(const std::string& name, const std::string& address, double now);
  void Failed(const std::string& name, const std::string& address, double now);
  /// Forgets the failures of the name from there.
  void Succeeded(const std::string& name, const std::string& address);

 private:
  using Key = std::pair<std::string, std::string>;  ///< address and name; no name: all of the address
  double WaitOf(const Key& key, std::size_t most, double now);

  const Options options_;
  std::map<Key, std::deque<double>> failures_;
};

}  // namespace hydroscope
