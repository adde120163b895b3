#include "report/text_sink.h"

#include <zlib.h>

#include <cerrno>

#include "core/cannot_write.h"

namespace hydroscope {

struct TextSink::State {
  std::string path;
  std::FILE* file = nullptr;
  gzFile packed = nullptr;
  bool failed = false;
  int error = 0;
};

TextSink::TextSink(std::unique_ptr<State> state) : state_(std::move(state)) {}
TextSink::TextSink(TextSink&&) noexcept = default;
TextSink::~TextSink() {
  if (state_ == nullptr) return;
  if (state_->packed != nullptr) gzclose(state_->packed);
  if (state_->file != nullptr && state_->file != stdout) std::fclose(state_->file);
}

Result<TextSink> TextSink::Open(const std::string& path) {
  auto state = std::make_unique<State>();
  state->path = path;
  errno = 0;
  if (path == "-") {
    state->file = stdout;
  } else if (path.ends_with(".gz")) {
    state->packed = gzopen(path.c_str(), "wb4");
  } else {
    state->file = std::fopen(path.c_str(), "wb");
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
  errno = 0;
  bool closed = true;
  if (s.packed != nullptr) closed = gzclose(s.packed) == Z_OK;
  if (s.file != nullptr) closed = (s.file == stdout ? std::fflush(s.file) : std::fclose(s.file)) == 0;
  if (!closed && s.error == 0) s.error = errno;
  s.packed = nullptr;
  s.file = nullptr;
  if (closed && !s.failed) return {};
  return CannotWrite(s.path == "-" ? "to standard output" : s.path, s.error);
}

Status WriteWhole(const std::string& path, std::string_view text) {
  auto sink = TextSink::Open(path);
  if (!sink) return tl::unexpected(sink.error());
  sink->Write(text);
  return sink->Close();
}

}  // namespace hydroscope
