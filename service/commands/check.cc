#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "service/check_output.h"
#include "service/commands.h"
#include "service/output.h"

namespace hydroscope {
namespace {

struct CheckArguments {
  std::string log, machine, json;
};

int Run(const CheckArguments& arguments) {
  const auto check = CheckLog(arguments.log, arguments.machine);
  if (!check) return ReportError(check.error());
  if (arguments.json != "-") std::cout << CheckText(*check, arguments.machine);
  if (!arguments.json.empty())
    if (const Status written = WriteJson(arguments.json, CheckJson(*check)); !written)
      return ReportError(written.error());
  return check->Clean() ? kDone : kPartlyDone;
}

}  // namespace

void AddCheckCommand(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<CheckArguments>();
  CLI::App* command = app.add_subcommand(
      "check", "Signal quality, gate and excitation of a log: what can be identified from it");
  command->add_option("log", arguments->log, "Log (CSV, CSV.gz or MAT)")->required();
  command->add_option("--machine,-m", arguments->machine, "Machine file (TOML)")->required();
  command->add_option("--json", arguments->json, "Write the result as JSON to this file; - is stdout");
  command->footer(
      "Exit code 4: rows or values are bad and would be left out; they are listed.\n"
      "Examples:\n"
      "  hydroscope check press.csv --machine press.toml\n"
      "  hydroscope check press.csv -m press.toml --json check.json");
  command->callback([arguments, &exit_code] { exit_code = Run(*arguments); });
}

}  // namespace hydroscope
