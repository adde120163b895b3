#pragma once

#include <sys/stat.h>

#include <cstdint>
#include <string>

namespace hydroscope {

/// Which file a name stands for at present: another one if the file was deleted, moved or replaced since,
/// which who has it open would not notice. All zero: there is none.
struct FileIdentity {
  dev_t device = 0;
  ino_t number = 0;

  static FileIdentity Of(const std::string& path) {
    struct stat now {};
    return stat(path.c_str(), &now) == 0 ? FileIdentity{now.st_dev, now.st_ino} : FileIdentity{};
  }
  bool exists() const { return number != 0; }
  bool operator==(const FileIdentity&) const = default;
};

/// ns since 1970, when somebody last wrote into the file; 0: there is none.
inline std::int64_t LastWritten(const std::string& path) {
  struct stat now {};
  if (stat(path.c_str(), &now) != 0) return 0;
  return static_cast<std::int64_t>(now.st_mtim.tv_sec) * 1'000'000'000 + now.st_mtim.tv_nsec;
}

}  // namespace hydroscope
