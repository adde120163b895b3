#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>

#include "cli/command_answer.h"
#include "cli/commands.h"
#include "cli/old_database.h"
#include "core/counted_words.h"
#include "review/stored_report.h"

namespace hydroscope {
namespace {

struct ReportArguments {
  std::string db, machine, out, json;
};

Status RunReport(const ReportArguments& a) {
  const std::string not_stored = SayIfOld(a.db);
  const auto written = TRY(WriteStoredReport(a.db, a.machine, a.out, not_stored));
  return Answer(fmt::format("{}: {} of {} in {}\n", a.out, written.counted.Counted(written.strokes),
                            written.machine, Counted(written.runs, "run")),
                {{"report", a.out},
                 {"machine", written.machine},
                 {"strokes", written.strokes},
                 {"runs", written.runs},
                 {"alarms", written.alarms},
                 {"not_stored", not_stored}},
                a.json);
}

}  // namespace

void AddReportCommand(CLI::App& app, int& exit_code) {
  auto a = std::make_shared<ReportArguments>();
  CLI::App* command = app.add_subcommand(
      "report", "The maintenance report of a database, also while `hydroscope serve` writes it");
  command->add_option("--db,-d", a->db, "Database that `hydroscope replay` or `serve` fills")->required();
  command->add_option("--machine,-m,--machine-name", a->machine,
                      "Name of the machine, if the database holds several");
  command->add_option("--out,-o", a->out, "Page to write (HTML)")->required();
  command->add_option("--json", a->json, "Write what the page rests on as JSON to this file; - is stdout");
  command->footer(
      "Examples:\n"
      "  hydroscope report --db press.db --out press.html\n"
      "  hydroscope report --db press.db --machine press/cushion_1 --out cushion_1.html");
  RunsAs(*command, exit_code, [a] { return RunReport(*a); });
}

}  // namespace hydroscope
