#pragma once

#include <deque>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/clock.h"
#include "page/access/role.h"
#include "storage/access_store.h"
#include "storage/file_identity.h"

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

/// Logins to the page of a service. Users, logins and the audit table are those of the file beside the database, which is
/// read at every question: what `hydroscope users` changes holds at once, and a restart ends no login. For one thread.
class Logins {
 public:
  static constexpr double kIdle = 3600;  ///< s without a request after which a login ends; an open page asks
  static constexpr double kLife = 12 * 3600;  ///< s after which it ends in any case: a shift

  Logins(std::string database, Clock clock) : database_(std::move(database)), clock_(std::move(clock)) {}

  /// Whether there is anybody who could log in.
  bool AnyUsers();

  struct Begun {
    std::string cookie;  ///< what the browser holds; "": not logged in
    double wait = 0;     ///< s: too many failures
    Who who;
  };
  /// Looks at name and password: 0.1 s, so that guessing takes long too. Errors: the file of users cannot be read.
  Result<Begun> Begin(const std::string& name, const std::string& password, const std::string& address);
  /// Who holds this; nobody where the login has ended.
  Who Find(const std::string& cookie);
  Status End(const std::string& cookie);

  /// Appends to the audit table.
  Status Record(const Who& who, const std::string& address, const std::string& what,
                const std::string& detail, const std::string& outcome = "");
  Result<std::vector<AuditRow>> Audit(std::int64_t most);

 private:
  /// The store; opened anew if its file was replaced.
  Result<AccessStore*> Store();
  double Wall() const { return Seconds(clock_().wall_ns); }

  const std::string database_;
  const Clock clock_;
  LoginLimiter limiter_;
  std::optional<AccessStore> store_;
  FileIdentity file_;
};

/// Whether a user may be called that: 1 to 64 letters, digits and . _ - @
bool IsUserName(const std::string& name);

}  // namespace hydroscope
