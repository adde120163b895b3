#include "page/work/scratch_folder.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>

namespace hydroscope {
namespace {

namespace fs = std::filesystem;

constexpr char kPrefix[] = "hydroscope_page_";
constexpr char kLockFile[] = "/in_use";

/// Whether the folder is this user's, and the program that made it is gone.
bool IsLeftBehind(const fs::path& folder) {
  struct stat found {};
  if (lstat(folder.c_str(), &found) != 0 || !S_ISDIR(found.st_mode) || found.st_uid != geteuid())
    return false;
  const int lock = open((folder.string() + kLockFile).c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW);
  if (lock < 0) return false;
  const bool free = flock(lock, LOCK_EX | LOCK_NB) == 0;
  close(lock);
  return free;
}

void RemoveLeftBehind(const fs::path& where) {
  std::error_code failure;
  for (const auto& entry : fs::directory_iterator(where, failure))
    if (entry.path().filename().string().starts_with(kPrefix) && IsLeftBehind(entry.path()))
      fs::remove_all(entry.path(), failure);
}

}  // namespace

Result<std::unique_ptr<ScratchFolder>> ScratchFolder::Make() {
  std::error_code failure;
  const fs::path where = fs::temp_directory_path(failure);
  if (!failure) RemoveLeftBehind(where);
  std::string name = where / (std::string(kPrefix) + "XXXXXX");
  if (failure || mkdtemp(name.data()) == nullptr)
    return InternalError("no temporary folder can be made ({}); set TMPDIR to one that can be written", name);
  const int lock = open((name + kLockFile).c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, S_IRUSR | S_IWUSR);
  if (lock < 0 || flock(lock, LOCK_EX | LOCK_NB) != 0) {
    if (lock >= 0) close(lock);
    fs::remove_all(name, failure);
    return InternalError("{} cannot be written; set TMPDIR to a folder that can", name);
  }
  return std::unique_ptr<ScratchFolder>(new ScratchFolder(name, lock));
}

ScratchFolder::~ScratchFolder() {
  std::error_code failure;
  fs::remove_all(path_, failure);
  close(lock_);
}

}  // namespace hydroscope
