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

Status WriteTextFile(const std::string& path, const std::string& text) {
  std::ofstream file(path, std::ios::binary);
  file << text;
  file.flush();
  if (!file)
    return BadInput(Tell("cannot write {}: check that the folder exists and the disk is not full",
                         "{} kann nicht geschrieben werden: gibt es den Ordner, und hat die Platte Platz?",
                         path));
  return {};
}

}  // namespace hydroscope
