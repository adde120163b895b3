#pragma once

#include <array>
#include <optional>
#include <string>

namespace hydroscope {

/// What somebody may do; each may what those before it may.
enum class UserRole {
  kNobody,   ///< not logged in
  kView,     ///< look
  kOperate,  ///< act on alarms, work on models
  kAdmin     ///< change what the machine is judged by, see what everybody did
};

inline constexpr std::array<const char*, 4> kRoleNames = {"nobody", "view", "operate", "admin"};

inline const char* RoleName(UserRole role) { return kRoleNames[static_cast<std::size_t>(role)]; }

/// Of "view", "operate", "admin".
inline std::optional<UserRole> RoleOf(const std::string& name) {
  for (const UserRole role : {UserRole::kView, UserRole::kOperate, UserRole::kAdmin})
    if (name == RoleName(role)) return role;
  return std::nullopt;
}

/// Who asks.
struct Who {
  std::string name;
  UserRole role = UserRole::kNobody;
  std::string token;  ///< what his requests that change something have to bring
};

}  // namespace hydroscope
