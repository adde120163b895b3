#include "dds/shared_memory.h"

#include <fcntl.h>
#include <pwd.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <chrono>
#include <random>
#include <string>

namespace hydroscope {
namespace {

namespace fs = std::filesystem;

constexpr char kPrefix[] = "fastrtps_";

/// s since the file was made or last changed. std::time() would not do: its clock is coarse and can be behind the file's.
double Age(const fs::path& file) {
  std::error_code gone;
  const fs::file_time_type changed = fs::last_write_time(file, gone);
  return gone ? 0 : std::chrono::duration<double>(fs::file_time_type::clock::now() - changed).count();
}

/// A lock file is free if nobody holds it; the library keeps it locked as long as its process lives.
bool LockIsFree(const fs::path& file) {
  const int open_file = open(file.c_str(), O_RDONLY | O_CLOEXEC);
  if (open_file < 0) return false;
  const bool free = flock(open_file, LOCK_EX | LOCK_NB) == 0;
  close(open_file);
  return free;
}

std::string NameOf(uid_t user) {
  char text[1024];
  passwd entry{}, *found = nullptr;
  if (getpwuid_r(user, &entry, text, sizeof(text), &found) == 0 && found != nullptr) return entry.pw_name;
  return std::to_string(user);
}

fs::path With(fs::path file, const char* ending) { return file += ending; }

/// `file` is a segment or port; its lock lies beside it: _el exclusive, _sl shared. A port without a lock was
/// made by a sender whose reader was gone already.
bool Dead(const fs::path& file, double age) {
  bool locked = false;
  for (const char* ending : {"_el", "_sl"}) {
    const fs::path lock = With(file, ending);
    if (!fs::exists(lock)) continue;
    locked = true;
    if (Age(lock) < age || !LockIsFree(lock)) return false;
  }
  return Age(file) >= age && (locked || file.filename().string().starts_with(std::string(kPrefix) + "port"));
}

}  // namespace

int RemoveDeadSharedMemory(const fs::path& folder, double age) {
  std::error_code error;
  int removed = 0;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    const std::string name = it->path().filename().string();
    if (!name.starts_with(kPrefix) || name.ends_with("_el") || name.ends_with("_sl")) continue;
    if (!Dead(it->path(), age)) continue;
    std::error_code ignored;
    for (const fs::path& file :
         {With(it->path(), "_el"), With(it->path(), "_sl"), folder / ("sem." + name + "_mutex"), it->path()})
      removed += fs::remove(file, ignored);
  }
  return removed;
}

SharedMemoryUsers UsersOfSharedMemory(const fs::path& folder) {
  SharedMemoryUsers users;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    const std::string name = it->path().filename().string();
    struct stat found {};
    if (!name.starts_with(kPrefix) || !(name.ends_with("_el") || name.ends_with("_sl")) ||
        stat(it->path().c_str(), &found) != 0 || LockIsFree(it->path()))
      continue;
    if (found.st_uid == geteuid())
      users.own = true;
    else
      users.other = NameOf(found.st_uid);
  }
  return users;
}

std::uint32_t UnusedSharedMemoryPort() {
  constexpr std::uint32_t kAboveAllOthers = 1u << 31;  // ports numbered by domain are below 2^16
  return kAboveAllOthers | (static_cast<std::uint32_t>(std::random_device()()) & 0x7fff'fff0u);
}

}  // namespace hydroscope
