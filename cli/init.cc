#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "cli/command_answer.h"
#include "cli/commands.h"
#include "core/shell_word.h"
#include "core/shown_width.h"
#include "host/output.h"
#include "host/text_sink.h"
#include "models/machine_kind.h"
#include "setup/kind_columns.h"
#include "setup/machine_proposal.h"

namespace hydroscope {
namespace {

struct InitArguments {
  std::string log, out, json, model;
  double area_cm2 = 0;
  bool force = false;
};

nlohmann::json ToJson(const MachineProposal& proposal) {
  nlohmann::json columns = nlohmann::json::array();
  for (const ProposedColumn& column : proposal.columns)
    columns.push_back({{"signal", column.signal},
                       {"column", column.column},
                       {"unit", column.unit},
                       {"why", column.why.english},
                       {"sure", column.sure}});
  return {{"model", proposal.machine.model},
          {"columns", columns},
          {"unused", proposal.unused},
          {"decided", InEnglish(proposal.decided)},
          {"to_fill_in", InEnglish(proposal.open)}};
}

const char* NextCommand(const MachineKind& kind) {
  return kind.build != nullptr || kind.has_states ? "check" : "frf";
}

/// What was found, for people.
std::string ReportText(const InitArguments& arguments, const MachineProposal& proposal) {
  std::size_t width = 6;
  for (const ProposedColumn& column : proposal.columns) width = std::max(width, ShownWidth(column.column));
  std::string text = fmt::format("{:<10} {:<{}}  unit\n", "signal", "column", width);
  for (const ProposedColumn& column : proposal.columns)
    text += fmt::format("{:<10} {:<{}}  {}\n    {}{}\n", column.signal, column.column, width, column.unit,
                        column.why.english, column.sure ? "" : "  <-- check");
  if (!proposal.unused.empty()) text += fmt::format("not used: {}\n", fmt::join(proposal.unused, ", "));
  text += "\n";
  for (const Told& line : proposal.decided) text += line.english + "\n";
  if (!proposal.open.empty()) text += "\nto fill in, marked \"<-- FILL IN\" in the file:\n";
  for (const Told& line : proposal.open) text += "  " + line.english + "\n";
  if (!arguments.out.empty())
    text += fmt::format("\nwritten: {}\nnext:    hydroscope {} {} --machine {}\n", arguments.out,
                        NextCommand(KindOf(proposal.machine)), ShellWord(arguments.log),
                        ShellWord(arguments.out));
  return text;
}

Status WriteFile(const InitArguments& arguments, const std::string& text) {
  if (!arguments.force && std::filesystem::exists(arguments.out))
    return UsageError("{} exists already; choose another name, or --force to replace it", arguments.out);
  return WriteTextFile(arguments.out, text);
}

Status RunInit(const InitArguments& arguments) {
  const auto head = TRY(ReadLogColumns(arguments.log));
  ProposalOptions options;
  options.model = arguments.model;
  if (arguments.area_cm2 > 0)  // the piston area of whatever machine it turns out to be
    for (const MachineKind* kind : MachineKinds())
      for (const MachineInput& known : kind->geometry)
        if (known.si == "m2") options.known[std::string(known.name)] = arguments.area_cm2 * 1e-4;
  const MachineProposal proposal = ProposeMachine(head, options);
  if (!arguments.out.empty()) {
    TRY(WriteFile(arguments, proposal.text));
  } else if (arguments.json != "-") {
    std::cout << proposal.text;
  }
  if (!arguments.json.empty()) TRY(WriteJson(arguments.json, ToJson(proposal)));
  const bool stdout_is_taken = arguments.out.empty() || arguments.json == "-";
  (stdout_is_taken ? SayBeside : Say)(ReportText(arguments, proposal));
  return {};
}

}  // namespace

void AddInitCommand(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<InitArguments>();
  CLI::App* command = app.add_subcommand("init", "Propose a machine file from a log: columns, units, model");
  command->add_option("LOG", arguments->log, "Log: CSV (plain or .gz) or MAT")->required();
  command->add_option("--out", arguments->out, "Machine file to write; without it, it goes to stdout");
  std::vector<std::string> kinds;
  for (const MachineKind* kind : KindsToChoose()) kinds.emplace_back(kind->id);
  command
      ->add_option(
          "--model", arguments->model,
          "Kind of machine, where it is not recognised: " + fmt::format("{}", fmt::join(kinds, ", ")))
      ->check(CLI::IsMember(kinds));
  command->add_option("--area", arguments->area_cm2, "Piston area on side A in cm2, if known")
      ->check(CLI::Range(1e-3, 1e5));
  command->add_option("--json", arguments->json, "What was inferred and why, as JSON (- is stdout)");
  command->add_flag("--force", arguments->force, "Replace an existing machine file");
  command->footer(
      "Columns are recognised by name (English and German) and by the size and motion "
      "of their numbers. Nothing is\n"
      "asked; guesses are marked \"<-- check\", what no log can tell is marked \"<-- FILL IN\".\n"
      "Examples:\n"
      "  hydroscope init press.csv --out press.toml\n"
      "  hydroscope init press.csv --area 125 --out press.toml\n"
      "  hydroscope init pump.csv --model pump --out pump.toml\n"
      "  hydroscope init sweep.csv > valve.toml");
  RunsAs(*command, exit_code, [arguments] { return RunInit(*arguments); });
}

}  // namespace hydroscope
