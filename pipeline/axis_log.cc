#include "pipeline/axis_log.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>

#include "core/told_error.h"
#include "pipeline/raw_log.h"
#include "storage/database_file.h"

namespace hydroscope {
namespace {

/// By what is in it; of a file that is not there, by its name.
bool IsDatabase(const std::string& path) {
  std::error_code ignored;
  return std::filesystem::exists(path, ignored) ? IsDatabaseFile(path) : path.ends_with(".db");
}

/// Names of axes that a log belongs to.
Result<std::vector<std::string>> AxesOf(const std::string& log, const Machine& machine,
                                        const std::string& axis) {
  if (const auto named = ParseAxisLog(log)) return std::vector{named->axis};
  if (const auto raw = ParseRawName(log); raw && !raw->axis.empty()) return std::vector{raw->axis};
  if (!axis.empty()) return std::vector{axis};
  if (LogHoldsAllAxes(machine)) return machine.live->axes;
  return BadInput(Tell(
      "{}: \"{}\" has the axes {}, and nothing tells whose log this is; write {}#{}, or give --axis {} for all logs",
      "{}: „{}“ hat die Achsen {}, und nichts sagt, wessen Log das ist; {}#{} schreiben, oder --axis {} für alle Logs",
      log, machine.name, fmt::join(machine.live->axes, ", "), log, machine.live->axes.front(),
      machine.live->axes.front()));
}

}  // namespace

std::optional<AxisLog> ParseAxisLog(const std::string& log) {
  const std::size_t hash = log.rfind('#');
  if (hash == std::string::npos || hash == 0 || hash + 1 == log.size()) return std::nullopt;
  AxisLog named{log.substr(0, hash), log.substr(hash + 1)};
  std::error_code ignored;
  if (std::filesystem::exists(log, ignored) || IsDatabase(named.path)) return std::nullopt;
  return named;
}

std::string PathOfLog(const std::string& log) {
  const auto named = ParseAxisLog(log);
  return named ? named->path : log;
}

Result<int> AxisNamed(const Machine& machine, const std::string& name) {
  for (int axis = 0; HasNamedAxes(machine) && axis < AxisCount(machine); ++axis)
    if (name == machine.live->axes[axis] || name == AxisMachineName(machine, axis)) return axis;
  if (!HasNamedAxes(machine))
    return BadInput(
        Tell("axis \"{}\": the machine file of \"{}\" names no axes; it would in [live] axes",
             "Achse „{}“: die Maschinendatei von „{}“ nennt keine Achsen; das täte sie in [live] axes", name,
             machine.name));
  return BadInput(Tell("axis \"{}\": \"{}\" has the axes {}", "Achse „{}“: „{}“ hat die Achsen {}", name,
                       machine.name, fmt::join(machine.live->axes, ", ")));
}

Result<std::vector<LogsOfAxis>> ShareOutLogs(const Machine& machine, const std::vector<std::string>& logs,
                                             const std::string& axis) {
  std::vector<LogsOfAxis> shares;
  const auto share = [&](int index) -> LogsOfAxis& {
    const auto known = std::ranges::find_if(shares, [&](const LogsOfAxis& s) { return s.axis == index; });
    return known != shares.end() ? *known : shares.emplace_back(LogsOfAxis{index, {}});
  };
  if (!HasNamedAxes(machine) && axis.empty()) return std::vector{LogsOfAxis{0, logs}};
  for (const std::string& log : logs) {
    const auto names = TRY(AxesOf(log, machine, axis));
    for (const std::string& name : names) {
      const auto index = TRY(AxisNamed(machine, name));
      share(index).logs.push_back(PathOfLog(log));
    }
  }
  return shares;
}

}  // namespace hydroscope
