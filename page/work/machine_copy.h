#pragma once

#include <filesystem>
#include <string>

#include "core/result.h"

namespace hydroscope {

/// The machine file a person works on: a copy. What the person has is changed by Save alone. Guarded by its owner.
class MachineCopy {
 public:
  /// `folder` is there and its own.
  explicit MachineCopy(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// Takes `text` as machine file `name`; Save is told where to write it. Error: it is no machine file.
  Status Take(const std::string& name, const std::string& text);
  /// Takes a file, to which Save writes, and the versions that are kept beside it. Error: it is no machine file.
  Status TakeFile(const std::string& path);
  void Forget();

  bool empty() const { return file_.empty(); }
  /// Path of the copy; "" = none yet.
  const std::string& file() const { return file_; }
  const std::string& target() const { return target_; }
  std::string Text() const;  ///< "" = none yet, or it cannot be read
  Status Write(const std::string& text);

  /// Says that `text` is kept elsewhere.
  void MarkSaved(const std::string& text) { saved_text_ = text; }
  bool Unsaved() const { return Text() != saved_text_; }
  /// Writes it to its target, whose version before is kept beside; where it has none, to `name` in the folder where the program
  /// was started. Returns the path. Errors: another file of that name is there; somebody else changed the target.
  Result<std::string> Save(const std::string& name);

 private:
  Status SaveAs(const std::string& name, const std::string& text);
  Status SaveBack() const;

  std::filesystem::path folder_;
  int taken_ = 0;  ///< machine files so far
  std::string file_;
  std::string target_;      ///< where Save writes; "" = has to be named
  std::string saved_text_;  ///< of `target_` when it was read or written last
};

}  // namespace hydroscope
