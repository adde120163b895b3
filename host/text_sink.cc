#include "host/text_sink.h"

#include <zlib.h>

#include <cerrno>
#include <filesystem>
#include <system_error>

#include "core/cannot_write.h"

namespace hydroscope {

struct TextSink::State {
  std::string path;
  std::filesystem::path whole, part;  // empty where it is written in place: stdout, devices, pipes
  std::FILE* file = nullptr;
  gzFile packed = nullptr;
  bool failed = false;
  int error = 0;

  /// Of what is a file, or will be one.
  void WriteBeside() {
    std::error_code ignored;
    if (std::filesystem::exists(path, ignored) && !std::filesystem::is_regular_file(path, ignored)) return;
    whole = std::filesystem::canonical(path, ignored);  // what a link leads to
    if (ignored) whole = path;
    part = whole;
    part += ".part";
  }
  bool TakeName() {
    std::error_code ignored;
    if (const auto before = std::filesystem::status(whole, ignored); std::filesystem::exists(before))
      std::filesystem::permissions(part, before.permissions(), ignored);
    return std::rename(part.c_str(), whole.c_str()) == 0;
  }
};

TextSink::TextSink(std::unique_ptr<State> state) : state_(std::move(state)) {}
TextSink::TextSink(TextSink&&) noexcept = default;
TextSink::~TextSink() {
  if (state_ == nullptr) return;
  state_->failed = true;
  static_cast<void>(Close());
}

Result<TextSink> TextSink::Open(const std::string& path) {
  auto state = std::make_unique<State>();
  state->path = path;
  if (path != "-") state->WriteBeside();
  const std::string name = state->part.empty() ? path : state->part.string();
  errno = 0;
  if (path == "-") {
    state->file = stdout;
  } else if (path.ends_with(".gz")) {
    state->packed = gzopen(name.c_str(), "wb4");
  } else {
    state->file = std::fopen(name.c_str(), "wb");
  }
  if (state->packed == nullptr && state->file == nullptr) return CannotWrite(path);
  return TextSink(std::move(state));
}

bool TextSink::Write(std::string_view text) {
  State& s = *state_;
  if (s.failed || text.empty()) return !s.failed;
  errno = 0;
  const std::size_t written = s.packed != nullptr ? gzfwrite(text.data(), 1, text.size(), s.packed)
                                                  : std::fwrite(text.data(), 1, text.size(), s.file);
  s.failed = written != text.size();
  if (s.failed) s.error = errno;
  return !s.failed;
}

Status TextSink::Close() {
  State& s = *state_;
  if (s.packed == nullptr && s.file == nullptr) return {};  // it is
  errno = 0;
  bool closed = true;
  if (s.packed != nullptr) closed = gzclose(s.packed) == Z_OK;
  if (s.file != nullptr) closed = (s.file == stdout ? std::fflush(s.file) : std::fclose(s.file)) == 0;
  s.packed = nullptr;
  s.file = nullptr;
  if (closed && !s.failed && (s.part.empty() || s.TakeName())) return {};
  if (s.error == 0) s.error = errno;
  std::error_code ignored;
  if (!s.part.empty()) std::filesystem::remove(s.part, ignored);
  return CannotWrite(s.path == "-" ? "to standard output" : s.path, s.error);
}

Status WriteTextFile(const std::string& path, std::string_view text) {
  auto sink = TRY(TextSink::Open(path));
  sink.Write(text);
  return sink.Close();
}

}  // namespace hydroscope
