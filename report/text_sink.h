#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "core/result.h"

namespace hydroscope {

/// Writes text to a file, gzip-compressed if the name ends in .gz, or to stdout if the name is "-".
class TextSink {
 public:
  static Result<TextSink> Open(const std::string& path);
  TextSink(TextSink&&) noexcept;
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

/// The whole text at once.
Status WriteWhole(const std::string& path, std::string_view text);

}  // namespace hydroscope
