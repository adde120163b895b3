#pragma once

#include "host/output.h"  // ExitCode

namespace CLI {
class App;
}

namespace hydroscope {

/// The commands, in the order of --help. Each lives in cli/<name>.cc, adds itself to `app` and leaves its exit code in
/// `exit_code` when it runs.
#define HYDROSCOPE_COMMANDS(_) \
  _(Init)                      \
  _(Check)                     \
  _(Design)                    \
  _(Simulate)                  \
  _(Fit)                       \
  _(Compare)                   \
  _(Explain)                   \
  _(Model)                     \
  _(Open)                      \
  _(Frf)                       \
  _(Replay)                    \
  _(Trends)                    \
  _(Serve)                     \
  _(Status)                    \
  _(VerifyLive)                \
  _(Alarms)                    \
  _(Users)                     \
  _(Learn)                     \
  _(Report)                    \
  _(Benchmark)

#define HYDROSCOPE_DECLARE_COMMAND(Name) void Add##Name##Command(CLI::App& app, int& exit_code);
HYDROSCOPE_COMMANDS(HYDROSCOPE_DECLARE_COMMAND)
#undef HYDROSCOPE_DECLARE_COMMAND

/// `completion` for bash and zsh and `manual`, from what all other commands say of themselves: added last.
void AddShellCommands(CLI::App& app, int& exit_code);
/// The benchmarks called live-...
void AddLiveBenchmarks(CLI::App& benchmark, int& exit_code);
void AddAlarmBenchmarks(CLI::App& benchmark, int& exit_code);

/// All commands with their options, as the program has them.
void AddCommands(CLI::App& app, int& exit_code);
/// The whole command line; returns the exit code. main() and the tests call it.
int RunCommandLine(int argc, const char* const* argv);

}  // namespace hydroscope
