#include "host/text_file.h"

#include <fstream>
#include <sstream>

namespace hydroscope {

Result<std::string> ReadTextFile(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::stringstream text;
  text << file.rdbuf();
  if (!file) return BadInput("cannot read {}", path);
  return text.str();
}

Status WriteTextFile(const std::string& path, const std::string& text) {
  std::ofstream file(path, std::ios::binary);
  file << text;
  file.flush();
  if (!file) return BadInput("cannot write {}: check that the folder exists and the disk is not full", path);
  return {};
}

}  // namespace hydroscope
