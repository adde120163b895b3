#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <string>
#include <utility>

#include "host/output.h"

namespace hydroscope {

/// Adds a study to `benchmark`, to run by `run`; returns its command, for options and examples, and what these set.
template <typename Options>
std::pair<CLI::App*, std::shared_ptr<Options>> AddStudy(CLI::App& benchmark, const std::string& name,
                                                        const std::string& purpose,
                                                        int (*run)(const Options&), int& exit_code) {
  CLI::App* command = benchmark.add_subcommand(name, purpose);
  const auto options = std::make_shared<Options>();
  command->callback([options, run, &exit_code] {
    const DroppedOutput none;  // of --quiet: the exit code tells whether a study reached its goals
    exit_code = run(*options);
  });
  return {command, options};
}

/// "--jobs" of a campaign: how many of its cases are worked on at once.
inline void AddJobs(CLI::App& campaign, int& threads) {
  campaign.add_option("--jobs,--threads", threads, "Threads, 0 = one per core")->check(CLI::Range(0, 256));
}

}  // namespace hydroscope
