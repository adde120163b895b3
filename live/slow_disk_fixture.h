#pragma once

#include <sqlite3.h>

#include <atomic>

namespace hydroscope {

/// A disk that takes its time: while one is `Hold`ing, who waits until a database file is safely on it waits on. Write-ahead
/// logs are as quick as ever. Concerns the databases that this process opens while the object lives, of which there is one.
class SlowDisk {
 public:
  SlowDisk() : before_(*sqlite3_vfs_find(nullptr)), slow_(before_) {
    instance_ = this;
    slow_.zName = "slow disk";
    slow_.xOpen = Open;
    sqlite3_vfs_register(&slow_, 1);
  }
  ~SlowDisk() {
    Release();
    sqlite3_vfs_unregister(&slow_);
    instance_ = nullptr;
  }
  SlowDisk(const SlowDisk&) = delete;
  SlowDisk& operator=(const SlowDisk&) = delete;

  void Hold() { held_ = true; }
  void Release() {
    held_ = false;
    held_.notify_all();
  }
  bool somebody_waits() const { return waiting_ > 0; }

 private:
  static int Open(sqlite3_vfs*, sqlite3_filename name, sqlite3_file* file, int flags, int* flags_out) {
    SlowDisk& disk = *instance_;
    const int opened = disk.before_.xOpen(&disk.before_, name, file, flags, flags_out);
    if (opened != SQLITE_OK || (flags & SQLITE_OPEN_MAIN_DB) == 0) return opened;
    if (!disk.quick_sync_) {  // the methods are the same of every file
      disk.quick_sync_ = file->pMethods->xSync;
      disk.methods_ = *file->pMethods;
      disk.methods_.xSync = Sync;
    }
    file->pMethods = &disk.methods_;
    return opened;
  }
  static int Sync(sqlite3_file* file, int flags) {
    SlowDisk& disk = *instance_;
    ++disk.waiting_;
    disk.held_.wait(true);
    --disk.waiting_;
    return disk.quick_sync_(file, flags);
  }

  inline static SlowDisk* instance_ = nullptr;
  sqlite3_vfs before_, slow_;
  sqlite3_io_methods methods_{};
  int (*quick_sync_)(sqlite3_file*, int) = nullptr;
  std::atomic<bool> held_ = false;
  std::atomic<int> waiting_ = 0;
};

}  // namespace hydroscope
