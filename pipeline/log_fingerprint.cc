#include "pipeline/log_fingerprint.h"

#include <zlib.h>

#include <algorithm>
#include <cinttypes>
#include <cstdio>
#include <fstream>
#include <vector>

#include "core/told_error.h"

namespace hydroscope {
namespace {

constexpr std::uint64_t kPrintedBytes = 64 * 1024;  // bytes
constexpr int kReplayVersion = 1;                   // raise when the same log and settings give other strokes

std::uint32_t Crc(std::ifstream& file, std::uint64_t at, std::uint64_t length) {
  std::vector<char> bytes(length);
  file.seekg(static_cast<std::streamoff>(at));
  file.read(bytes.data(), static_cast<std::streamsize>(length));
  return static_cast<std::uint32_t>(
      crc32(0, reinterpret_cast<const Bytef*>(bytes.data()), static_cast<uInt>(file.gcount())));
}

std::uint64_t SizeOf(std::ifstream& file) {
  file.seekg(0, std::ios::end);
  return static_cast<std::uint64_t>(std::max<std::streamoff>(0, file.tellg()));
}

}  // namespace

std::string LogFingerprint::Text() const {
  return fmt::format("{}-{:08x}-{:08x}-{:08x}", size, head, middle, tail);
}

Result<LogFingerprint> FingerprintLog(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file)
    return BadInput(Tell("{}: cannot be opened; does the file exist and may it be read?",
                         "{}: kann nicht geöffnet werden; gibt es die Datei, und darf sie gelesen werden?",
                         path));
  LogFingerprint print;
  print.size = SizeOf(file);
  const std::uint64_t chunk = std::min(print.size, kPrintedBytes);
  print.head = Crc(file, 0, chunk);
  print.middle = Crc(file, (print.size - chunk) / 2, chunk);
  print.tail = Crc(file, print.size - chunk, chunk);
  if (!file)
    return BadInput(Tell("{}: cannot be read; is it a folder, or the disk damaged?",
                         "{}: kann nicht gelesen werden; ist es ein Ordner, oder die Platte beschädigt?",
                         path));
  return print;
}

Result<bool> Continues(const std::string& path, const LogFingerprint& earlier) {
  std::ifstream file(path, std::ios::binary);
  if (!file)
    return BadInput(Tell("{}: cannot be opened; does the file exist and may it be read?",
                         "{}: kann nicht geöffnet werden; gibt es die Datei, und darf sie gelesen werden?",
                         path));
  if (earlier.size == 0 || SizeOf(file) <= earlier.size) return false;
  const std::uint64_t chunk = std::min(earlier.size, kPrintedBytes);
  return Crc(file, 0, chunk) == earlier.head &&
         Crc(file, (earlier.size - chunk) / 2, chunk) == earlier.middle &&
         Crc(file, earlier.size - chunk, chunk) == earlier.tail;
}

std::string FingerprintSettings(const Machine& machine, const std::string& state_layout) {
  Machine identified = machine;
  identified.name.clear();
  identified.description.clear();
  identified.monitors.clear();
  identified.model_history.clear();
  identified.model_version = 1;
  const std::string text = FormatMachine(identified) + state_layout;
  const auto crc = crc32(0, reinterpret_cast<const Bytef*>(text.data()), static_cast<uInt>(text.size()));
  return fmt::format("{:08x}-v{}", static_cast<std::uint32_t>(crc), kReplayVersion);
}

bool RunFingerprint::Parse(const std::string& text, RunFingerprint& out) {
  const auto slash = text.find('/');
  if (slash == std::string::npos) return false;
  out.settings = text.substr(slash + 1);
  return std::sscanf(text.c_str(), "%" SCNu64 "-%" SCNx32 "-%" SCNx32 "-%" SCNx32, &out.log.size,
                     &out.log.head, &out.log.middle, &out.log.tail) == 4;
}

}  // namespace hydroscope
