#include "page/whole_file.h"

#include <fstream>
#include <sstream>

namespace hydroscope {

std::string ReadWhole(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

Status WriteWhole(const std::string& path, const std::string& text) {
  std::ofstream file(path, std::ios::binary);
  file << text;
  file.flush();
  if (!file) return BadInput("cannot write {}: check that the folder exists and the disk is not full", path);
  return {};
}

}  // namespace hydroscope
