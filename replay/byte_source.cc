#include "replay/byte_source.h"

#include <fcntl.h>
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
  if (!IsGzip(descriptor)) return std::make_unique<PlainFile>(path, descriptor, size);
  const gzFile file = gzdopen(descriptor, "rb");
  if (file == nullptr) {
    ::close(descriptor);
    return InternalError(
        Tell("log '{}': out of memory for unpacking", "Log '{}': kein Speicher mehr zum Entpacken", path));
  }
  gzbuffer(file, 1u << 20);
  return std::make_unique<GzipFile>(path, file, size);
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
