#include "replay/byte_source.h"

#include <fcntl.h>
#include <iconv.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "core/told_error.h"
#include "replay/decimal.h"

namespace hydroscope {
namespace {

class PlainFile : public ByteSource {
 public:
  PlainFile(std::string path, int descriptor, double size)
      : path_(std::move(path)), descriptor_(descriptor), size_(size) {}
  ~PlainFile() override { ::close(descriptor_); }
  PlainFile(const PlainFile&) = delete;
  PlainFile& operator=(const PlainFile&) = delete;

  Result<std::size_t> Read(char* data, std::size_t size) override {
    ssize_t got;
    do {
      got = ::read(descriptor_, data, size);
    } while (got < 0 && errno == EINTR);
    if (got < 0)
      return BadInput(Tell("log '{}': cannot be read further: {}",
                           "Log '{}': kann nicht weiter gelesen werden: {}", path_, std::strerror(errno)));
    done_ += static_cast<double>(got);
    return static_cast<std::size_t>(got);
  }
  double Progress() const override { return size_ > 0 ? std::min(1.0, done_ / size_) : 1.0; }

 private:
  std::string path_;
  int descriptor_;
  double size_;
  double done_ = 0;
};

class GzipFile : public ByteSource {
 public:
  GzipFile(std::string path, gzFile file, double size) : path_(std::move(path)), file_(file), size_(size) {}
  ~GzipFile() override { gzclose(file_); }
  GzipFile(const GzipFile&) = delete;
  GzipFile& operator=(const GzipFile&) = delete;

  Result<std::size_t> Read(char* data, std::size_t size) override {
    const int got = gzread(file_, data, static_cast<unsigned>(std::min<std::size_t>(size, 1u << 30)));
    int code = Z_OK;
    const char* text = gzerror(file_, &code);
    if (got < 0 || (got == 0 && code != Z_OK && code != Z_STREAM_END))
      return BadInput(Tell(
          "log '{0}': the compressed data are damaged or cut off ({1}); unpack what can be saved with "
          "`gzip -dc {0} > log.csv` and read that",
          "Log '{0}': die gepackten Daten sind beschädigt oder abgeschnitten ({1}); was zu retten ist, mit "
          "`gzip -dc {0} > log.csv` auspacken und das lesen",
          path_, text));
    return static_cast<std::size_t>(got);
  }
  double Progress() const override {
    return size_ > 0 ? std::min(1.0, static_cast<double>(gzoffset(file_)) / size_) : 1.0;
  }

 private:
  std::string path_;
  gzFile file_;
  double size_;
};

/// UTF-16 text, as spreadsheets write "Unicode text", in UTF-8.
class Utf16Text : public ByteSource {
 public:
  /// `source` stands behind the byte order mark.
  Utf16Text(std::unique_ptr<ByteSource> source, bool little, std::string path)
      : source_(std::move(source)),
        path_(std::move(path)),
        converter_(iconv_open("UTF-8", little ? "UTF-16LE" : "UTF-16BE")) {}
  ~Utf16Text() override {
    if (converter_ != kNone) iconv_close(converter_);
  }
  Utf16Text(const Utf16Text&) = delete;
  Utf16Text& operator=(const Utf16Text&) = delete;

  Result<std::size_t> Read(char* data, std::size_t size) override {
    if (converter_ == kNone)
      return InternalError(Tell("log '{}': this computer converts no UTF-16; save it as UTF-8",
                                "Log '{}': dieser Rechner wandelt kein UTF-16 um; als UTF-8 speichern",
                                path_));
    for (;;) {
      char* out = data;
      std::size_t room = size;
      char* in = rest_.data();
      std::size_t left = rest_.size();
      const std::size_t done = iconv(converter_, &in, &left, &out, &room);
      const int error = done == static_cast<std::size_t>(-1) ? errno : 0;
      rest_.erase(0, rest_.size() - left);
      if (error == EILSEQ)
        return BadInput(Tell("log '{}': damaged UTF-16 text; save it anew as UTF-8",
                             "Log '{}': beschädigter Text in UTF-16; neu als UTF-8 speichern", path_));
      if (out > data) return static_cast<std::size_t>(out - data);
      const std::size_t before = rest_.size();
      rest_.resize(before + kPiece);
      const auto got = source_->Read(rest_.data() + before, kPiece);
      rest_.resize(before + got.value_or(0));
      if (!got || *got == 0) return got;
    }
  }
  double Progress() const override { return source_->Progress(); }

 private:
  static constexpr std::size_t kPiece = 1u << 18;
  static inline const iconv_t kNone = reinterpret_cast<iconv_t>(-1);

  std::unique_ptr<ByteSource> source_;
  std::string path_;
  iconv_t converter_;
  std::string rest_;  ///< bytes that are not converted yet
};

enum class Utf16 { kNo, kLittle, kBig };

/// By the byte order mark that the text begins with.
Utf16 Utf16Of(const char* first_two) {
  if (std::memcmp(first_two, "\xFF\xFE", 2) == 0) return Utf16::kLittle;
  return std::memcmp(first_two, "\xFE\xFF", 2) == 0 ? Utf16::kBig : Utf16::kNo;
}

std::unique_ptr<ByteSource> AsUtf8(std::unique_ptr<ByteSource> source, Utf16 kind, const std::string& path) {
  if (kind == Utf16::kNo) return source;
  return std::make_unique<Utf16Text>(std::move(source), kind == Utf16::kLittle, path);
}

bool IsGzip(int descriptor) {
  unsigned char magic[2] = {};
  return ::pread(descriptor, magic, 2, 0) == 2 && magic[0] == 0x1f && magic[1] == 0x8b;
}

}  // namespace

Result<std::unique_ptr<ByteSource>> OpenFileSource(const std::string& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0)
    return BadInput(Tell("log '{}': cannot be opened: {}", "Log '{}': kann nicht geöffnet werden: {}", path,
                         std::strerror(errno)));
  struct stat info = {};
  if (::fstat(descriptor, &info) == 0 && S_ISDIR(info.st_mode)) {
    ::close(descriptor);
    return BadInput(Tell("log '{}' is a directory; name the log file in it",
                         "Log '{}' ist ein Ordner; die Datei darin nennen", path));
  }
  const double size = static_cast<double>(info.st_size);
  char first_two[2] = {};
  if (!IsGzip(descriptor)) {
    const bool read = ::pread(descriptor, first_two, 2, 0) == 2;
    const Utf16 kind = read ? Utf16Of(first_two) : Utf16::kNo;
    if (kind != Utf16::kNo) ::lseek(descriptor, 2, SEEK_SET);
    return AsUtf8(std::make_unique<PlainFile>(path, descriptor, size), kind, path);
  }
  const gzFile file = gzdopen(descriptor, "rb");
  if (file == nullptr) {
    ::close(descriptor);
    return InternalError(
        Tell("log '{}': out of memory for unpacking", "Log '{}': kein Speicher mehr zum Entpacken", path));
  }
  gzbuffer(file, 1u << 20);
  const Utf16 kind = gzread(file, first_two, 2) == 2 ? Utf16Of(first_two) : Utf16::kNo;
  if (kind == Utf16::kNo) gzrewind(file);
  return AsUtf8(std::make_unique<GzipFile>(path, file, size), kind, path);
}

LineBuffer::LineBuffer(std::unique_ptr<ByteSource> source, std::string origin)
    : source_(std::move(source)), origin_(std::move(origin)) {
  Reserve(kChunk);
}

void LineBuffer::Reserve(std::size_t capacity) {
  // One byte for the line end a last line may lack, and what ParseDecimal may read beyond it.
  auto larger = std::make_unique<char[]>(capacity + 1 + kDecimalPadding);
  if (end_ > begin_) std::memcpy(larger.get(), buffer_.get() + begin_, end_ - begin_);
  end_ -= begin_;
  complete_ -= std::min(complete_, begin_);
  begin_ = 0;
  buffer_ = std::move(larger);
  capacity_ = capacity;
}

Result<bool> LineBuffer::Fill() {
  if (begin_ < complete_) return true;
  std::memmove(buffer_.get(), buffer_.get() + begin_, end_ - begin_);
  end_ -= begin_;
  begin_ = complete_ = 0;
  while (!at_end_) {
    if (end_ == capacity_) {
      if (capacity_ >= kLongestLine)
        return BadInput(Tell("log '{}': no line end within {} MB; this is not a text log",
                             "Log '{}': kein Zeilenende in {} MB; das ist kein Log aus Text", origin_,
                             kLongestLine >> 20));
      Reserve(capacity_ * 2);
    }
    const auto got = TRY(source_->Read(buffer_.get() + end_, capacity_ - end_));
    const std::size_t searched = end_;
    end_ += got;
    if (got == 0) {
      at_end_ = true;
      if (end_ == 0) return false;
      buffer_[end_++] = '\n';
    }
    const void* last = ::memrchr(buffer_.get() + searched, '\n', end_ - searched);
    if (last == nullptr) continue;
    complete_ = static_cast<std::size_t>(static_cast<const char*>(last) - buffer_.get()) + 1;
    return true;
  }
  return false;
}

}  // namespace hydroscope
