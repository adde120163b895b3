#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <iostream>
#include <nlohmann/json.hpp>

#include "service/commands.h"
#include "service/model_edit.h"
#include "service/model_output.h"
#include "service/output.h"

namespace hydroscope {
namespace {

struct ModelOptions {
  std::string machine, effect, out, json;
};

void Show(const std::string& text, const nlohmann::json& document, const std::string& json, int& exit_code) {
  if (json != "-") std::cout << text;
  if (json.empty()) return;
  if (const Status written = WriteJson(json, document); !written) exit_code = ReportError(written.error());
}

void AddEffectsCommand(CLI::App& model, const std::shared_ptr<ModelOptions>& options, int& exit_code) {
  CLI::App* command =
      model.add_subcommand("effects", "The library: every effect with law, parameter and look-alikes");
  command->add_option("--json", options->json, "Write the result as JSON to this file; - is stdout");
  command->footer("Examples:\n  hydroscope model effects\n  hydroscope model effects --json -");
  command->callback([options, &exit_code] { Show(EffectsText(), EffectsJson(), options->json, exit_code); });
}

void AddShowCommand(CLI::App& model, const std::shared_ptr<ModelOptions>& options, int& exit_code) {
  CLI::App* command =
      model.add_subcommand("show", "The model of a machine file: what is known, effects, version");
  command->add_option("--machine,-m", options->machine, "Machine file (TOML)")->required();
  command->add_option("--json", options->json, "Write the result as JSON to this file; - is stdout");
  command->footer("Examples:\n  hydroscope model show --machine press.toml");
  command->callback([options, &exit_code] {
    const auto machine = LoadMachine(options->machine);
    if (!machine) {
      exit_code = ReportError(machine.error());
      return;
    }
    Show(ModelText(*machine), ModelJson(*machine), options->json, exit_code);
  });
}

/// Writes the next version of the machine file and says what was done.
Status Change(const ModelOptions& options, Result<Machine> (*change)(const Machine&, const std::string&)) {
  const auto machine = LoadMachine(options.machine);
  if (!machine) return tl::unexpected(machine.error());
  const auto next = change(*machine, options.effect);
  if (!next) return tl::unexpected(next.error());
  const std::string path = options.out.empty() ? options.machine : options.out;
  const auto kept = WriteVersion(options.machine, path, machine->model_version, *next);
  if (!kept) return tl::unexpected(kept.error());
  std::cout << fmt::format("{}: model version {}\n", path, next->model_version);
  if (!kept->empty()) std::cout << fmt::format("The version before is kept as {}\n", *kept);
  std::cout << fmt::format("See the error with it: hydroscope compare LOG --machine {}\n", path);
  return {};
}

void AddChangeCommand(CLI::App& model, const std::shared_ptr<ModelOptions>& options, int& exit_code,
                      const std::string& name, const std::string& what,
                      Result<Machine> (*change)(const Machine&, const std::string&)) {
  CLI::App* command = model.add_subcommand(name, what);
  command->add_option("effect", options->effect, "Id of the effect, see 'hydroscope model effects'")
      ->required();
  command->add_option("--machine,-m", options->machine, "Machine file (TOML)")->required();
  command->add_option(
      "--out,-o", options->out,
      "Write the new version here; without it the machine file itself is changed and the version "
      "before kept beside it");
  command->footer(
      fmt::format("Examples:\n  hydroscope model {0} internal_leakage --machine press.toml\n"
                  "  hydroscope model {0} internal_leakage -m press.toml --out press_next.toml",
                  name));
  command->callback([options, change, &exit_code] {
    if (const Status done = Change(*options, change); !done) exit_code = ReportError(done.error());
  });
}

}  // namespace

void AddModelCommand(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<ModelOptions>();
  CLI::App* model =
      app.add_subcommand("model", "Effects of the library, and which are part of a machine's model");
  model->require_subcommand(1);
  model->footer(
      "Examples:\n  hydroscope model effects\n  hydroscope model add internal_leakage --machine press.toml");
  AddEffectsCommand(*model, options, exit_code);
  AddShowCommand(*model, options, exit_code);
  AddChangeCommand(*model, options, exit_code, "add", "Make an effect part of the model", WithEffect);
  AddChangeCommand(*model, options, exit_code, "remove", "Take an effect out of the model", WithoutEffect);
}

}  // namespace hydroscope
