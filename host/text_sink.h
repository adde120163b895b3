#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "core/result.h"

namespace hydroscope {

/// Writes text to a file, gzip-compressed if the name ends in .gz, or to stdout if the name is "-". A file is there as a whole
/// or not at all: it is written beside under the name PATH.part and takes its own when it is closed, so that one that is cut
/// short, by a full disk or Ctrl-C, neither looks whole nor costs the one that was there before.
class TextSink {
 public:
  static Result<TextSink> Open(const std::string& path);
  TextSink(TextSink&&) noexcept;
  /// What was not closed is taken away.
  ~TextSink();
  /// False once anything could not be written; Close() then says why.
  bool Write(std::string_view text);
  /// Flushes and closes; the error names the file.
  Status Close();

 private:
  struct State;
  explicit TextSink(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// The whole text at once. Error: it cannot be written.
Status WriteTextFile(const std::string& path, std::string_view text);

}  // namespace hydroscope
