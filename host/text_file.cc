#include "host/text_file.h"

#include <fstream>
#include <sstream>

#include "core/told_error.h"

namespace hydroscope {

Result<std::string> ReadTextFile(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::stringstream text;
  text << file.rdbuf();
  if (!file) return BadInput(Tell("cannot read {}", "{} kann nicht gelesen werden", path));
  return text.str();
}

}  // namespace hydroscope
