#include "workbench/history/history_options.h"

#include <CLI/CLI.hpp>

#include "core/shell_word.h"

namespace hydroscope {

void AddHistoryOptions(CLI::App& command, HistoryOptions& o) {
  command.add_option("--db,-d", o.db, "Database that 'hydroscope replay' filled, in place of a log");
  command.add_option("--machine-name", o.machines, "Machine of the database, repeatable; all without it");
  command.add_option("--from", o.from,
                     "First stroke or episode: number, log (run:3), time (81.5s) or date (2025-03-01)");
  command.add_option("--to", o.to, "Stroke or episode before which to stop, likewise");
  command.add_flag("--fleet", o.fleet, "Take the machines chosen together, as if they were one");
}

Result<ChosenHistory> OpenHistory(const HistoryOptions& options, const std::string& machine_file) {
  auto database = TRY(Database::OpenReadOnly(options.db));
  auto parts = TRY(ChosenMachines(database, options.db, options.machines));
  ChosenHistory out{std::move(database), {}};
  for (HistoryPart& part : parts) {
    TRY(Narrow(out.database, options.from, options.to, part));
    if (options.fleet && !out.choices.empty()) {
      out.choices.front().parts.push_back(part);
      continue;
    }
    const auto machine =
        TRY(machine_file.empty() ? StoredMachine(out.database, options.db, part) : LoadMachine(machine_file));
    const std::string target =
        !machine_file.empty() ? "--machine " + ShellWord(machine_file)
        : parts.size() > 1
            ? fmt::format("--db {} --machine-name {}", ShellWord(options.db), ShellWord(part.machine))
            : "--db " + ShellWord(options.db);
    out.choices.push_back({{part}, machine, target});
  }
  return out;
}

Result<std::pair<StrokeHistory, StrokeHistory>> Split(const Database& database, const std::string& path,
                                                      const HistoryChoice& choice, const std::string& since) {
  std::vector<HistoryPart> before = choice.parts, after = choice.parts;
  for (std::size_t k = 0; k < choice.parts.size(); ++k) {
    TRY(Narrow(database, "", since, before[k]));
    TRY(Narrow(database, since, "", after[k]));
  }
  auto then = TRY(LoadHistory(database, path, before, choice.machine));
  auto now = TRY(LoadHistory(database, path, after, choice.machine));
  return std::make_pair(std::move(then), std::move(now));
}

}  // namespace hydroscope
