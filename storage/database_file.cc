#include "storage/database_file.h"

#include <SQLiteCpp/SQLiteCpp.h>
#include <sqlite3.h>

#include <filesystem>
#include <string_view>

namespace hydroscope {

bool IsDatabaseFile(const std::string& path) {
  constexpr std::string_view kMagic = "SQLite format 3";
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) return false;  // a pipe can be read only once
  try {
    const SQLite::Database file(path, SQLite::OPEN_READONLY);  // reads nothing by itself, and locks nothing
    sqlite3_file* opened = nullptr;
    std::string head(kMagic.size(), '\0');
    return sqlite3_file_control(file.getHandle(), "main", SQLITE_FCNTL_FILE_POINTER, &opened) == SQLITE_OK &&
           opened->pMethods != nullptr &&
           opened->pMethods->xRead(opened, head.data(), static_cast<int>(head.size()), 0) == SQLITE_OK &&
           head == kMagic;
  } catch (const SQLite::Exception&) {
    return false;
  }
}

}  // namespace hydroscope
