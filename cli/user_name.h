#pragma once

#include <fmt/format.h>
#include <unistd.h>

#include <cstdlib>
#include <string>

namespace hydroscope {

/// Who runs the program: USER of the environment, else the number.
inline std::string UserName() {
  const char* user = std::getenv("USER");
  return user != nullptr ? user : fmt::format("uid {}", getuid());
}

}  // namespace hydroscope
