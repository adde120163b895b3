#pragma once

#include <fcntl.h>
#include <unistd.h>

#include <string>

namespace hydroscope {

/// Holds the lock of SQLite's one writer (byte 120 of the index of the write-ahead log,
/// https://sqlite.org/walformat.html, 2.3.3), as another program does that writes for long.
class WriteLock {
 public:
  explicit WriteLock(const std::string& database)
      : file_(open((database + "-shm").c_str(), O_RDWR | O_CLOEXEC)) {
    struct flock lock {};
    lock.l_type = F_WRLCK;
    lock.l_whence = SEEK_SET;
    lock.l_start = 120;
    lock.l_len = 1;
    held_ = file_ >= 0 && fcntl(file_, F_SETLKW, &lock) == 0;
  }
  ~WriteLock() {
    if (file_ >= 0) close(file_);
  }
  WriteLock(const WriteLock&) = delete;
  WriteLock& operator=(const WriteLock&) = delete;
  bool held() const { return held_; }

 private:
  int file_;
  bool held_ = false;
};

}  // namespace hydroscope
