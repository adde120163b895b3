#pragma once

#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>

#include "core/result.h"

namespace hydroscope {

/// A folder that only this user can read, removed with all it holds at the end.
class ScratchFolder {
 public:
  /// In the system's folder for temporary files. Error: it cannot be made there.
  static Result<std::unique_ptr<ScratchFolder>> Make() {
    std::error_code failure;
    std::string name = std::filesystem::temp_directory_path(failure) / "hydroscope_page_XXXXXX";
    if (failure || mkdtemp(name.data()) == nullptr)
      return InternalError("no temporary folder can be made ({}); set TMPDIR to one that can be written",
                           name);
    return std::unique_ptr<ScratchFolder>(new ScratchFolder(name));
  }
  ~ScratchFolder() {
    std::error_code failure;
    std::filesystem::remove_all(path_, failure);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  const std::string& path() const { return path_; }

 private:
  explicit ScratchFolder(std::string path) : path_(std::move(path)) {}
  const std::string path_;
};

}  // namespace hydroscope
