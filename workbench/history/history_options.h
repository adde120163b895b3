#pragma once

#include <string>
#include <utility>
#include <vector>

#include "workbench/history/stroke_history.h"

namespace CLI {
class App;
}

namespace hydroscope {

/// Options of the commands that work on a database.
struct HistoryOptions {
  std::string db;
  std::vector<std::string> machines;
  std::string from, to;
  bool fleet = false;
};
void AddHistoryOptions(CLI::App& command, HistoryOptions& options);

/// Strokes judged together: one machine, or a fleet.
struct HistoryChoice {
  std::vector<HistoryPart> parts;
  Machine machine;     ///< with the model in force
  std::string target;  ///< how the command line names it: "--db press.db --machine-name 'press 7'"
};

struct ChosenHistory {
  Database database;
  std::vector<HistoryChoice> choices;  ///< one per machine, or a single one for --fleet
};

/// Opens the database for reading and finds the strokes asked for. `machine_file` replaces the stored model;
/// "" = none.
Result<ChosenHistory> OpenHistory(const HistoryOptions& options, const std::string& machine_file);

/// The strokes before and from `since` on.
Result<std::pair<StrokeHistory, StrokeHistory>> Split(const Database& database, const std::string& path,
                                                      const HistoryChoice& choice, const std::string& since);

}  // namespace hydroscope
