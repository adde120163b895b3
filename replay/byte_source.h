#pragma once

#include <memory>
#include <string>

#include "core/result.h"

namespace hydroscope {

/// Bytes of a log from beginning to end, read in big pieces.
class ByteSource {
 public:
  virtual ~ByteSource() = default;
  /// Reads up to `size` bytes; 0 at the end. An error names the file and what went wrong.
  virtual Result<std::size_t> Read(char* data, std::size_t size) = 0;
  /// Share read, 0...1.
  virtual double Progress() const = 0;
};

/// Opens a plain or gzip-compressed file (told by its first bytes, not by its name). UTF-16 text with a byte order mark is read
/// as UTF-8.
Result<std::unique_ptr<ByteSource>> OpenFileSource(const std::string& path);

/// Cuts a byte source into complete lines inside one buffer that grows only for long lines.
class LineBuffer {
 public:
  static constexpr std::size_t kChunk = std::size_t{1} << 18;        ///< bytes read at once
  static constexpr std::size_t kLongestLine = std::size_t{1} << 24;  ///< bytes; a longer line is an error

  explicit LineBuffer(std::unique_ptr<ByteSource> source, std::string origin);

  /// Makes sure that at least one complete line lies in [cursor, limit); false at the end of the source.
  /// Lines end with '\n'; one is appended to a last line without. What is before the cursor is dropped.
  Result<bool> Fill();
  const char* cursor() const { return buffer_.get() + begin_; }
  const char* limit() const { return buffer_.get() + complete_; }
  void Advance(const char* to) { begin_ = static_cast<std::size_t>(to - buffer_.get()); }
  bool at_end() const { return at_end_; }
  double Progress() const { return source_->Progress(); }

 private:
  void Reserve(std::size_t capacity);

  std::unique_ptr<ByteSource> source_;
  std::string origin_;
  std::unique_ptr<char[]> buffer_;
  std::size_t capacity_ = 0;
  std::size_t begin_ = 0;     ///< first byte not yet taken
  std::size_t complete_ = 0;  ///< end of the last complete line
  std::size_t end_ = 0;       ///< end of the bytes read
  bool at_end_ = false;
};

}  // namespace hydroscope
