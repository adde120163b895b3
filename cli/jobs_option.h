#pragma once

#include <CLI/CLI.hpp>

namespace hydroscope {

/// "--jobs" of a campaign: how many of its cases are worked on at once.
inline void AddJobs(CLI::App& campaign, int& threads) {
  campaign.add_option("--jobs,--threads", threads, "Threads, 0 = one per core")
      ->check(CLI::Range(0, 256))
      ->capture_default_str();
}

}  // namespace hydroscope
