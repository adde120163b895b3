#pragma once

#include <fmt/format.h>
#include <pwd.h>
#include <unistd.h>

#include <cstdlib>
#include <string>

namespace hydroscope {

/// Who runs the program: USER of the environment, else the name that the system knows, else the number.
inline std::string UserName() {
  if (const char* user = std::getenv("USER"); user != nullptr && *user != '\0') return user;
  const passwd* known = getpwuid(getuid());
  return known != nullptr ? known->pw_name : fmt::format("uid {}", getuid());
}

}  // namespace hydroscope
