#include "live/process_use.h"

#include <dirent.h>
#include <unistd.h>

#include <fstream>
#include <sstream>

namespace hydroscope {

ProcessUse UseOf(const std::string& process) {
  ProcessUse use;
  const std::string folder = "/proc/" + process;
  std::ifstream stat(folder + "/stat");
  std::string line;
  std::getline(stat, line);
  const std::size_t name_end = line.rfind(')');
  if (name_end == std::string::npos) return use;
  std::istringstream fields(line.substr(name_end + 2));
  std::string field;
  double user = 0, system = 0;
  std::int64_t pages = 0;
  for (int i = 3; i <= 24 && fields >> field; ++i) {  // proc(5): 14 utime, 15 stime, 24 rss
    if (i == 14) user = std::stod(field);
    if (i == 15) system = std::stod(field);
    if (i == 24) pages = std::stoll(field);
  }
  use.cpu = (user + system) / static_cast<double>(sysconf(_SC_CLK_TCK));
  use.memory = pages * sysconf(_SC_PAGESIZE);
  if (DIR* open_files = opendir((folder + "/fd").c_str())) {
    while (const dirent* entry = readdir(open_files)) use.descriptors += entry->d_name[0] != '.';
    closedir(open_files);
    if (process == "self") --use.descriptors;  // the folder itself
  }
  return use;
}

}  // namespace hydroscope
