#include "workbench/history/history_options.h"

#include <CLI/CLI.hpp>

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
  auto database = Database::OpenReadOnly(options.db);
  if (!database) return tl::unexpected(database.error());
  auto parts = ChosenMachines(*database, options.db, options.machines);
  if (!parts) return tl::unexpected(parts.error());
  ChosenHistory out{std::move(*database), {}};
  for (HistoryPart& part : *parts) {
    if (const Status narrowed = Narrow(out.database, options.from, options.to, part); !narrowed)
      return tl::unexpected(narrowed.error());
    if (options.fleet && !out.choices.empty()) {
      out.choices.front().parts.push_back(part);
      continue;
    }
    const auto machine =
        machine_file.empty() ? StoredMachine(out.database, options.db, part) : LoadMachine(machine_file);
    if (!machine) return tl::unexpected(machine.error());
    const std::string target = !machine_file.empty() ? "--machine " + machine_file
                               : parts->size() > 1
                                   ? fmt::format("--db {} --machine-name '{}'", options.db, part.machine)
                                   : "--db " + options.db;
    out.choices.push_back({{part}, *machine, target});
  }
  return out;
}

Result<std::pair<StrokeHistory, StrokeHistory>> Split(const Database& database, const std::string& path,
                                                      const HistoryChoice& choice, const std::string& since) {
  std::vector<HistoryPart> before = choice.parts, after = choice.parts;
  for (std::size_t k = 0; k < choice.parts.size(); ++k) {
    if (const Status cut = Narrow(database, "", since, before[k]); !cut) return tl::unexpected(cut.error());
    if (const Status cut = Narrow(database, since, "", after[k]); !cut) return tl::unexpected(cut.error());
  }
  auto then = LoadHistory(database, path, before, choice.machine);
  if (!then) return tl::unexpected(then.error());
  auto now = LoadHistory(database, path, after, choice.machine);
  if (!now) return tl::unexpected(now.error());
  return std::make_pair(std::move(*then), std::move(*now));
}

}  // namespace hydroscope
