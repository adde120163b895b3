#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/result.h"

namespace hydroscope {

/// Version of the tables of users, in `PRAGMA user_version`; docs/access.md describes them.
inline constexpr int kAccessFormat = 1;
/// "HYDU", in `PRAGMA application_id`.
inline constexpr int kAccessApplicationId = 0x48594455;

/// Who may use the page of a service.
struct StoredUser {
  std::string name, role;
  std::string password;  ///< its hash with how it was made, never itself
  double since = 0;      ///< s since 1970
};

/// A login that has not ended. `id` is a hash of what the browser holds, which is stored nowhere.
struct StoredSession {
  std::string id, user;
  std::string token;           ///< that requests which change something bring
  double begun = 0, seen = 0;  ///< s since 1970
};

/// One row of the audit table.
struct AuditRow {
  std::int64_t sequence = 0;  ///< given by the table
  double wall = 0;            ///< s since 1970
  std::string user, role;
  std::string from;     ///< address of who asked; "" = at the command line
  std::string what;     ///< "watch/alarms", "login"
  std::string detail;   ///< what was asked
  std::string outcome;  ///< "" = as asked, else why not
};

/// Users of a service's page, their logins, and what they changed, in a file of its own beside the trend database that only
/// its owner reads. Audit rows are only ever appended: triggers refuse to change or delete one. Errors as of Database, and
/// others may read the file.
class AccessStore {
 public:
  /// "press.db" -> "press.access.db".
  static std::string PathFor(const std::string& database);
  /// Makes the file for its owner alone, who is that of `database` (or of its folder) where root makes it.
  static Result<AccessStore> Open(const std::string& database);
  /// Never creates the file.
  static Result<AccessStore> OpenExisting(const std::string& database);
  AccessStore(AccessStore&&) noexcept;
  AccessStore& operator=(AccessStore&&) noexcept;
  ~AccessStore();

  /// In order of name.
  Result<std::vector<StoredUser>> Users() const;
  Result<std::optional<StoredUser>> User(const std::string& name) const;
  /// New, or in place of the one of this name, whose logins end.
  Status PutUser(const StoredUser& user);
  /// Ends the logins too. Error: there is none.
  Status RemoveUser(const std::string& name);

  Result<std::optional<StoredSession>> Session(const std::string& id) const;
  Status AddSession(const StoredSession& session);
  Status SeeSession(const std::string& id, double seen);
  Status EndSession(const std::string& id);
  /// Those begun before `begun` or not seen since `seen`.
  Status EndOldSessions(double begun, double seen);

  Status Append(const AuditRow& row);
  /// The newest `most`, newest first.
  Result<std::vector<AuditRow>> Audit(std::int64_t most) const;

 private:
  struct Impl;
  explicit AccessStore(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace hydroscope
