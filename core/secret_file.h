#pragma once

#include <sys/stat.h>

#include <string>

#include "core/result.h"

namespace hydroscope {

/// Error: anybody on this computer may read the file, which holds a password or a private key. `where` names
/// the setting: "[feeds.sparkplug] password_file".
inline Status CheckSecret(const std::string& path, const std::string& where) {
  struct stat found {};
  if (stat(path.c_str(), &found) != 0 || (found.st_mode & S_IROTH) == 0) return {};
  return BadInput(
      "{} = \"{}\" may be read by every user of this computer; `chmod 640` it, "
      "and give it to the group of the service",
      where, path);
}

}  // namespace hydroscope
