#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/clock.h"
#include "page/access/login_limiter.h"
#include "page/access/role.h"
#include "storage/access_store.h"
#include "storage/file_identity.h"

namespace hydroscope {

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
