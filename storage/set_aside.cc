#include "storage/set_aside.h"

#include <fmt/chrono.h>

#include <ctime>
#include <filesystem>

namespace hydroscope {
namespace {

namespace fs = std::filesystem;

/// With a number behind if the name is taken.
std::string DatedName(const std::string& path, double wall) {
  const fs::path file(path);
  const std::string date = fmt::format("{:%Y%m%dT%H%M%SZ}", fmt::gmtime(static_cast<std::time_t>(wall)));
  for (int number = 1;; ++number) {
    const std::string stem = fmt::format("{}.{}{}", file.stem().string(), date,
                                         number > 1 ? fmt::format("-{}", number) : std::string());
    const fs::path dated = file.parent_path() / (stem + file.extension().string());
    std::error_code ignored;
    if (!fs::exists(dated, ignored)) return dated.string();
  }
}

}  // namespace

Result<std::string> SetAside(const std::string& path, double wall) {
  const std::string to = DatedName(path, wall);
  for (const char* part : {"-wal", "-shm", ""}) {
    std::error_code error;
    if (!fs::exists(path + part, error)) continue;
    fs::rename(path + part, to + part, error);
    if (error) return BadInput("{}{} cannot be renamed to {}{}: {}", path, part, to, part, error.message());
  }
  return to;
}

}  // namespace hydroscope
