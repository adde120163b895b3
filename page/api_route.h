#pragma once

#include <string>
#include <vector>

#include "page/access/role.h"

namespace hydroscope {

inline constexpr const char* kApi = "/api/v1/";

/// What the API answers; docs/openapi.json describes each.
struct ApiRoute {
  const char *method, *path;  ///< path below kApi
  /// Who may ask at the least; what only looks (kView) nobody has to log in for where this computer alone reaches the page.
  UserRole role = UserRole::kView;
  bool recorded = false;  ///< in the audit table: what stays when the program ends
};

/// All of them.
std::vector<ApiRoute> ApiRoutes();
/// nullptr: there is none.
const ApiRoute* FindRoute(const std::string& method, const std::string& path);

/// Who may ask this at the least. What is no route needs the most, but for files of the front end, which anybody may load, and
/// other things to be looked at.
UserRole RoleNeeded(const std::string& method, const std::string& path);

}  // namespace hydroscope
