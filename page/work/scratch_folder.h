#pragma once

#include <memory>
#include <string>

#include "core/result.h"

namespace hydroscope {

/// A folder that only this user can read, removed with all it holds at the end. What programs that were killed left behind is
/// removed by the next one of the same user.
class ScratchFolder {
 public:
  /// In the system's folder for temporary files. Error: it cannot be made there.
  static Result<std::unique_ptr<ScratchFolder>> Make();
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  const std::string& path() const { return path_; }

 private:
  ScratchFolder(std::string path, int lock) : path_(std::move(path)), lock_(lock) {}
  const std::string path_;
  const int lock_;  ///< file in the folder, locked as long as the folder is in use
};

}  // namespace hydroscope
