#include "studies/simulated_replay.h"

#include <fmt/format.h>
#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <fstream>

#include "core/cannot_write.h"
#include "simulator/die_cushion/log_format.h"
#include "simulator/die_cushion/press.h"
#include "studies/simulated_strokes.h"

namespace hydroscope {
namespace {

Status SaveText(const std::string& text, const std::string& path) {
  std::ofstream file(path, std::ios::binary);
  file << text;
  if (!file.flush()) return CannotWrite(path);
  return {};
}

Status SaveLog(const PressOptions& options, const std::string& path) {
  PressGenerator press(options);
  std::string text(kPressLogHeader);
  for (PressRow row; press.Next(row);) AppendPressLine(row, text);
  return SaveText(text, path);
}

/// The machine file that reads such logs.
Status SaveMachine(const PressOptions& options, const std::string& path) {
  Machine machine = MachineFor(options);
  for (SignalSpec& signal : machine.signals)
    if (signal.name == "T_oil") signal.unit = "degC";
  return SaveText(FormatMachine(machine), path);
}

}  // namespace

WorkFolder::WorkFolder() {
  static std::atomic<int> count = 0;
  path_ = (std::filesystem::temp_directory_path() / fmt::format("hydroscope_runs_{}_{}", getpid(), ++count))
              .string();
  std::filesystem::create_directories(path_);
}

WorkFolder::~WorkFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

std::string WorkFolder::File(const std::string& name) const {
  return (std::filesystem::path(path_) / name).string();
}

Result<ReplayOutcome> ReplaySimulated(const std::vector<PressOptions>& runs, const WorkFolder& folder,
                                      const std::string& database, const std::string& report) {
  ReplayOptions replay;
  replay.machine_file = folder.File("machine.toml");
  replay.database = database;
  replay.report = report;
  TRY(SaveMachine(runs.front(), replay.machine_file));
  for (std::size_t run = 0; run < runs.size(); ++run) {
    replay.logs.push_back(folder.File(fmt::format("run_{:02}.csv", run + 1)));
    TRY(SaveLog(runs[run], replay.logs.back()));
  }
  auto replayed = TRY(RunReplay(replay));
  return std::move(replayed.machines.front());
}

}  // namespace hydroscope
