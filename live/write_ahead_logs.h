#pragma once

#include <string>
#include <vector>

#include "storage/file_identity.h"

namespace hydroscope {

/// The files "-wal" and "-shm" beside databases in use. SQLite keeps in them what was written last. Where somebody deletes them
/// (a clean-up of odd-looking files) this process goes on with the deleted ones, and all others see an older database: no alarm
/// where one stands. Only closing the database, which writes all into it, and opening it again brings both together.
class WriteAheadLogs {
 public:
  /// The databases are open already, as far as they exist.
  explicit WriteAheadLogs(const std::vector<std::string>& databases) {
    for (const std::string& database : databases)
      for (const char* ending : {"-wal", "-shm"})
        files_.push_back(
            {database, database + ending, FileIdentity::Of(database), FileIdentity::Of(database + ending)});
  }

  /// One that is no longer the file it was beside the same database; "" if there is none.
  std::string Gone() {
    for (File& file : files_) {
      const FileIdentity now = FileIdentity::Of(file.path);
      if (!file.of.exists()) file.of = FileIdentity::Of(file.database);
      if (FileIdentity::Of(file.database) != file.of) continue;  // another database: told by who writes it
      if (!file.seen.exists()) file.seen = now;
      if (file.seen != now) return file.path;
    }
    return "";
  }

 private:
  struct File {
    std::string database, path;
    FileIdentity of, seen;
  };
  std::vector<File> files_;
};

}  // namespace hydroscope
