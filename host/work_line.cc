#include "host/work_line.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <utility>

#include "host/output.h"

namespace hydroscope {

WorkLine::WorkLine(std::string task) : task_(std::move(task)), start_(std::chrono::steady_clock::now()) {
  if (IsQuiet() || isatty(STDERR_FILENO) == 0) return;
  clock_ = std::jthread([this](const std::stop_token& ended) {
    std::unique_lock lock(mutex_);
    while (!ended.stop_requested()) {
      Draw();
      told_.wait_for(lock, ended, std::chrono::seconds(1), [] { return false; });
    }
    std::fputs("\r\033[K", stderr);
  });
}

WorkLine::~WorkLine() = default;  // the clock ends first, and clears the line

void WorkLine::Tell(std::string what) {
  const std::lock_guard lock(mutex_);
  what_ = std::move(what);
  if (clock_.joinable()) Draw();
}

void WorkLine::Draw() const {
  const double elapsed = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  std::fputs(fmt::format("\r{}: {}  {:.0f} s\033[K", task_, what_, elapsed).c_str(), stderr);
}

}  // namespace hydroscope
