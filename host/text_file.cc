#include "host/text_file.h"

#include <fstream>
#include <sstream>

#include "core/cannot_write.h"
#include "core/told_error.h"

namespace hydroscope {

Result<std::string> ReadTextFile(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::stringstream text;
  text << file.rdbuf();
  if (!file) return BadInput(Tell("cannot read {}", "{} kann nicht gelesen werden", path));
  return text.str();
}

Status WriteTextFile(const std::string& path, const std::string& text) {
  errno = 0;
  std::ofstream file(path, std::ios::binary);
  file << text;
  file.flush();
  if (!file) return CannotWrite(path);
  return {};
}

}  // namespace hydroscope
