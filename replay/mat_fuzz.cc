// libFuzzer target: whatever a MAT file holds, its columns read as they were announced, or an error says why not.
#include <sys/mman.h>
#include <unistd.h>

#include <cstdlib>
#include <string>

#include "replay/mat_reader.h"

namespace {

using namespace hydroscope;

constexpr std::int64_t kMostRows = 4096;

/// A file in memory, which matio can open by its name.
class MemoryFile {
 public:
  MemoryFile(const std::uint8_t* data, std::size_t size) : file_(memfd_create("fuzz.mat", MFD_CLOEXEC)) {
    if (file_ < 0 || write(file_, data, size) != static_cast<ssize_t>(size)) std::abort();
  }
  ~MemoryFile() { close(file_); }
  std::string name() const { return "/proc/self/fd/" + std::to_string(file_); }

 private:
  int file_;
};

void ReadAll(MatColumns& columns) {
  for (std::size_t c = 0; c < columns.names().size(); ++c) {
    const std::int64_t rows = columns.rows(c);
    if (rows < 2) std::abort();
    const std::int64_t count = rows < kMostRows ? rows : kMostRows;
    std::vector<double> values(static_cast<std::size_t>(count));
    for (const std::int64_t first : {std::int64_t{0}, rows - count})
      if (const Status read = columns.Read(c, first, count, values.data());
          !read && read.error().text.empty())
        std::abort();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const MemoryFile file(data, size);
  if (!IsMatFile(file.name())) return 0;
  const auto columns = MatColumns::Open(file.name());
  if (!columns) return columns.error().text.empty() ? std::abort(), 0 : 0;
  ReadAll(**columns);
  return 0;
}
