#include "dds/domains.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <filesystem>
#include <string>

namespace hydroscope {

int FreeDomain() {
  constexpr int kDomains = 90;
  const int first = static_cast<int>(getpid()) % kDomains;
  for (int k = 0; k < kDomains; ++k) {
    const int domain = 1 + (first + k) % kDomains;
    const auto path =
        std::filesystem::temp_directory_path() / ("hydroscope_domain_" + std::to_string(domain));
    const int lock = open(path.c_str(), O_RDONLY | O_CREAT | O_CLOEXEC, 0644);
    if (lock < 0) continue;                                  // another user's
    if (flock(lock, LOCK_EX | LOCK_NB) == 0) return domain;  // and stays open
    close(lock);
  }
  return 1 + first;
}

}  // namespace hydroscope
