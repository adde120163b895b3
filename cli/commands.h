#pragma once

#include "host/output.h"  // ExitCode

namespace CLI {
class App;
}

namespace hydroscope {

/// Every command lives in cli/<name>.cc, adds itself to `app` and leaves its exit code in
/// `exit_code` when it runs.
void AddInitCommand(CLI::App& app, int& exit_code);
void AddCheckCommand(CLI::App& app, int& exit_code);
void AddSimulateCommand(CLI::App& app, int& exit_code);
void AddFitCommand(CLI::App& app, int& exit_code);
void AddCompareCommand(CLI::App& app, int& exit_code);
void AddExplainCommand(CLI::App& app, int& exit_code);
void AddModelCommand(CLI::App& app, int& exit_code);
void AddFrfCommand(CLI::App& app, int& exit_code);
void AddReplayCommand(CLI::App& app, int& exit_code);
void AddTrendsCommand(CLI::App& app, int& exit_code);
void AddServeCommand(CLI::App& app, int& exit_code);
void AddStatusCommand(CLI::App& app, int& exit_code);
void AddVerifyLiveCommand(CLI::App& app, int& exit_code);
void AddAlarmsCommand(CLI::App& app, int& exit_code);
void AddLearnCommand(CLI::App& app, int& exit_code);
void AddReportCommand(CLI::App& app, int& exit_code);
void AddBenchmarkCommand(CLI::App& app, int& exit_code);
/// `completion` for bash and zsh and `manual`, from what all other commands say of themselves: added last.
void AddShellCommands(CLI::App& app, int& exit_code);
/// The benchmarks called live-...
void AddLiveBenchmarks(CLI::App& benchmark, int& exit_code);
void AddAlarmBenchmarks(CLI::App& benchmark, int& exit_code);

/// The whole command line; returns the exit code. main() and the tests call it.
int RunCommandLine(int argc, const char* const* argv);

}  // namespace hydroscope
