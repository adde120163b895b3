#include "page/access/login_limiter.h"

#include <algorithm>

namespace hydroscope {

double LoginLimiter::Wait(const std::string& name, const std::string& address, double now) {
  for (auto at = failures_.begin(); at != failures_.end();) {
    std::deque<double>& times = at->second;
    while (!times.empty() && times.front() <= now - options_.window) times.pop_front();
    at = times.empty() ? failures_.erase(at) : std::next(at);
  }
  if (failures_.size() >= options_.remembered) return options_.window;
  return std::max(WaitOf({address, name}, options_.of_name, now),
                  WaitOf({address, ""}, options_.of_address, now));
}

double LoginLimiter::WaitOf(const Key& key, std::size_t most, double now) {
  const auto found = failures_.find(key);
  if (found == failures_.end() || found->second.size() < most) return 0;
  return found->second[found->second.size() - most] + options_.window - now;
}

void LoginLimiter::Failed(const std::string& name, const std::string& address, double now) {
  failures_[{address, name}].push_back(now);
  failures_[{address, ""}].push_back(now);
}

void LoginLimiter::Succeeded(const std::string& name, const std::string& address) {
  failures_.erase({address, name});
}

}  // namespace hydroscope
