#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/result.h"
#include "models/machine.h"

namespace hydroscope {

/// A log and the axis of the press that is meant, written "press.csv#cushion_1".
struct AxisLog {
  std::string path, axis;
};
/// nullopt if `log` is no such name: there is no '#', a file has this very name, or what stands before the
/// '#' is no log (a database and its axis are a raw window, pipeline/raw_log.h).
std::optional<AxisLog> ParseAxisLog(const std::string& log);
/// The file, without the axis.
std::string PathOfLog(const std::string& log);

/// Index of an axis, named as in the machine file ("cushion_1") or in the database ("press/cushion_1").
/// Error: there is none of this name.
Result<int> AxisNamed(const Machine& machine, const std::string& name);

/// Logs of one axis, in the order given.
struct LogsOfAxis {
  int axis = 0;
  std::vector<std::string> logs;  ///< files, or raw windows
};
/// Shares out logs among the axes of a machine file: a log belongs to the axis it names, else to `axis` (""
/// = not said), else to every axis if the columns of the machine file have "{axis}" in their names. Axes in
/// the order in which logs first name them. Error: nothing tells whose log it is.
Result<std::vector<LogsOfAxis>> ShareOutLogs(const Machine& machine, const std::vector<std::string>& logs,
                                             const std::string& axis);

}  // namespace hydroscope
