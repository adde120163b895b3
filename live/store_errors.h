#pragma once

#include <string>

#include "core/result.h"

namespace hydroscope {

inline bool ErrorSays(const Error& error, const std::string& text) {
  return error.text.find(text) != std::string::npos;
}

/// Whether storing failed because the file at `path` is damaged, as storage/connection.cc words it.
inline bool IsDamage(const Error& error, const std::string& path) {
  return ErrorSays(error, path + " is damaged (") || ErrorSays(error, "not an SQLite file");
}

/// Whether it passes when somebody frees space, unlocks or repairs the disk; then the same step is tried again.
inline bool MayPass(const Error& error) {
  return ErrorSays(error, "file is gone") || ErrorSays(error, "disk is full") ||
         ErrorSays(error, "another process") || ErrorSays(error, "cannot be written") ||
         ErrorSays(error, "cannot open") || ErrorSays(error, "SQLite error");
}

}  // namespace hydroscope
