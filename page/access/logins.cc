#include "page/access/logins.h"

#include <algorithm>
#include <cctype>

#include "page/access/secrets.h"

namespace hydroscope {
namespace {

constexpr double kSeenEvery = 60;  ///< s between two notes that a login is in use
constexpr std::size_t kLongestName = 64;
constexpr std::size_t kLongestDetail = 4000;  ///< bytes of a request that the audit table keeps

}  // namespace

bool IsUserName(const std::string& name) {
  return !name.empty() && name.size() <= kLongestName &&
         std::all_of(name.begin(), name.end(), [](unsigned char c) {
           return std::isalnum(c) != 0 || c == '.' || c == '_' || c == '-' || c == '@';
         });
}

Result<AccessStore*> Logins::Store() {
  const FileIdentity now = FileIdentity::Of(AccessStore::PathFor(database_));
  if (store_ && now == file_) return &*store_;
  store_.reset();
  store_ = TRY(AccessStore::OpenExisting(database_));
  file_ = now;
  return &*store_;
}

bool Logins::AnyUsers() {
  const auto store = Store();
  if (!store) return false;
  const auto users = (*store)->Users();
  return users && !users->empty();
}

Result<Logins::Begun> Logins::Begin(const std::string& name, const std::string& password,
                                    const std::string& address) {
  const double now = Seconds(clock_().monotonic_ns), wall = Wall();
  if (const double wait = limiter_.Wait(name, address, now); wait > 0) return Begun{"", wait, {}};
  const auto store = TRY(Store());
  const auto user = TRY(store->User(name));
  const std::string hash = user ? user->password : "";
  const auto role = user ? RoleOf(user->role) : std::nullopt;
  if (!IsPassword(hash, password) || !role) {
    limiter_.Failed(name, address, now);
    const std::string shown = IsUserName(name) ? name : "";  // somebody may type the password there
    TRY(Record({shown, UserRole::kNobody, ""}, address, "login", "", "refused"));
    return Begun{};
  }
  limiter_.Succeeded(name, address);
  Begun begun{RandomToken(), 0, {name, *role, RandomToken()}};
  TRY(Record(begun.who, address, "login", ""));
  TRY(store->EndOldSessions(wall - kLife, wall - kIdle));
  TRY(store->AddSession({HashOfToken(begun.cookie), name, begun.who.token, wall, wall}));
  return begun;
}

Who Logins::Find(const std::string& cookie) {
  if (cookie.empty()) return {};
  const auto store = Store();
  if (!store) return {};
  const auto session = (*store)->Session(HashOfToken(cookie));
  if (!session || !*session) return {};
  const StoredSession& s = **session;
  const double wall = Wall();
  if (wall - s.begun > kLife || wall - s.seen > kIdle) return {};
  const auto user = (*store)->User(s.user);
  const auto role = user && *user ? RoleOf((*user)->role) : std::nullopt;
  if (!role) return {};
  if (wall - s.seen > kSeenEvery)
    (void)(*store)->SeeSession(s.id, wall);  // if not now, with the next request
  return {s.user, *role, s.token};
}

Status Logins::End(const std::string& cookie) {
  const auto store = Store();
  return store ? (*store)->EndSession(HashOfToken(cookie)) : tl::unexpected(store.error());
}

Status Logins::Record(const Who& who, const std::string& address, const std::string& what,
                      const std::string& detail, const std::string& outcome) {
  const auto store = TRY(Store());
  return store->Append(
      {0, Wall(), who.name, RoleName(who.role), address, what, detail.substr(0, kLongestDetail), outcome});
}

Result<std::vector<AuditRow>> Logins::Audit(std::int64_t most) {
  const auto store = TRY(Store());
  return store->Audit(most);
}

}  // namespace hydroscope
