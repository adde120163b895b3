#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "cli/command_answer.h"
#include "cli/commands.h"
#include "cli/user_name.h"
#include "host/real_clock.h"
#include "workbench/model/model_change.h"
#include "workbench/model/model_edit.h"
#include "workbench/model/model_history_output.h"
#include "workbench/model/model_output.h"

namespace hydroscope {
namespace {

struct ModelOptions {
  std::string machine, json;
  ModelChange change;
  Promotion promotion;
};

void AddEffectsCommand(CLI::App& model, const std::shared_ptr<ModelOptions>& options, int& exit_code) {
  CLI::App* command =
      model.add_subcommand("effects", "The library: every effect with law, parameter and look-alikes");
  command->add_option("--machine,-m", options->machine,
                      "Machine file (TOML): the effects tried on this machine, those of its own too");
  AddJsonOption(*command, options->json);
  command->footer(
      "Examples:\n  hydroscope model effects\n  hydroscope model effects --machine "
      "machines/seal_friction.toml\n"
      "  hydroscope model effects --json -");
  RunsAs(*command, exit_code, [options]() -> Status {
    if (options->machine.empty()) return Answer(EffectsText(), EffectsJson(), options->json);
    const auto machine = TRY(LoadMachine(options->machine));
    return Answer(EffectsText(&machine), EffectsJson(&machine), options->json);
  });
}

void AddShowCommand(CLI::App& model, const std::shared_ptr<ModelOptions>& options, int& exit_code) {
  CLI::App* command =
      model.add_subcommand("show", "The model of a machine file: what is known, effects, version");
  command->add_option("--machine,-m", options->machine, "Machine file (TOML)")->required();
  AddJsonOption(*command, options->json);
  command->footer("Examples:\n  hydroscope model show --machine press.toml");
  RunsAs(*command, exit_code, [options]() -> Status {
    const auto machine = TRY(LoadMachine(options->machine));
    return Answer(ModelText(machine), ModelJson(machine), options->json);
  });
}

nlohmann::json ChangedJson(const ModelChanged& changed) {
  nlohmann::json out = ModelHistoryJson(changed.machine);
  out["where"] = changed.where;
  out["restored"] = changed.restored;
  out["error"] = changed.error;
  out["held_out"] = changed.held_out;
  out["warnings"] = InEnglish(changed.warnings);
  return out;
}

Status Tell(const Result<ModelChanged>& changed, const std::string& json) {
  return changed ? Answer(changed->text, ChangedJson(*changed), json) : tl::unexpected(changed.error());
}

void AddChangeCommand(CLI::App& model, const std::shared_ptr<ModelOptions>& options, int& exit_code,
                      const std::string& name, const std::string& what, MakeNext make_next) {
  CLI::App* command = model.add_subcommand(name, what);
  ModelChange& change = options->change;
  command->add_option("EFFECT", change.effect, "Id of the effect, see 'hydroscope model effects'")
      ->required();
  command->add_option(
      "LOG", change.logs,
      "Logs of one machine: on their strokes or episodes the model before and after is judged");
  command->add_option("--hold-out", change.hold_out,
                      "Log the models are not fitted to: their errors on it are given as well");
  command->add_option("--machine,-m", change.machine,
                      "Machine file (TOML); without it the model of --db is changed");
  command->add_option("--out,-o", change.out,
                      "Write the new version here; without it the machine file itself is changed and the "
                      "version before kept beside it");
  command->add_option("--name", change.name, "Name of the new version, for 'model history'");
  AddHistoryOptions(*command, change.history);
  AddJsonOption(*command, options->json);
  command->footer(fmt::format(
      "Examples:\n  hydroscope model {0} internal_leakage press.csv --machine press.toml\n"
      "  hydroscope model {0} internal_leakage -m press.toml --out press_next.toml\n"
      "  hydroscope model {0} pressure_friction -m seal.toml 1bar.csv 3bar.csv 5bar.csv --hold-out 3bar.csv\n"
      "  hydroscope model {0} internal_leakage --db press.db",
      name));
  RunsAs(*command, exit_code,
         [options, make_next] { return Tell(ChangeModel(options->change, make_next), options->json); });
}

void AddUndoCommand(CLI::App& model, const std::shared_ptr<ModelOptions>& options, int& exit_code) {
  CLI::App* command = model.add_subcommand("undo", "Bring the machine file from before the last change back");
  command->add_option("--machine,-m", options->machine, "Machine file (TOML)")->required();
  AddJsonOption(*command, options->json);
  command->footer("Examples:\n  hydroscope model undo --machine press.toml");
  RunsAs(*command, exit_code, [options] { return Tell(UndoModel(options->machine), options->json); });
}

void AddPromoteCommand(CLI::App& model, const std::shared_ptr<ModelOptions>& options, int& exit_code) {
  CLI::App* command = model.add_subcommand("promote", "Make a model the one of replay and monitor");
  HistoryOptions& history = options->change.history;
  command->add_option("--db,-d", history.db, "Database")->required();
  command->add_option("--machine,-m", options->machine, "Machine file (TOML) whose model to take");
  command->add_option("--machine-name", history.machines, "Machine of the database, if it holds several");
  command
      ->add_option("--version", options->promotion.version, "Version in the database; its latest without it")
      ->check(CLI::PositiveNumber);
  command->add_option("--user", options->promotion.user, "Who promotes (default: the user logged in)");
  command->add_option("--comment", options->promotion.comment, "Why, kept in the alarm journal");
  AddJsonOption(*command, options->json);
  command->footer(
      "Logs replayed later use it; what was replayed before stays as it is, and so do old versions. It stands\n"
      "in the alarm journal. A model whose effects need a signal that the machine does not record is refused.\n"
      "Examples:\n"
      "  hydroscope model promote --machine press.toml --db press.db\n"
      "  hydroscope model promote --db press.db --version 1");
  RunsAs(*command, exit_code, [options] {
    Promotion& promotion = options->promotion;
    if (promotion.user.empty()) promotion.user = UserName();
    promotion.wall = WallSeconds();
    return Tell(PromoteModel(options->change.history, options->machine, promotion), options->json);
  });
}

Status ShowHistory(const ModelOptions& options) {
  const HistoryOptions& history = options.change.history;
  if (options.machine.empty() == history.db.empty())
    return UsageError("model history needs --machine FILE or --db FILE");
  if (history.db.empty()) {
    const auto machine = TRY(LoadMachine(options.machine));
    return Answer(ModelHistoryText(machine), ModelHistoryJson(machine), options.json);
  }
  auto database = TRY(Database::OpenReadOnly(history.db));
  const auto parts = TRY(ChosenMachines(database, history.db, history.machines));
  std::string text;
  nlohmann::json machines = nlohmann::json::array();
  for (const HistoryPart& part : parts) {
    const auto machine = TRY(NewestStoredModel(database, part));
    const auto versions = TRY(database.ModelVersions(part.id));
    text += (text.empty() ? "" : "\n") + ModelHistoryText(machine) + StoredVersionsText(versions);
    machines.push_back(ModelHistoryJson(machine));
    machines.back()["stored"] = StoredVersionsJson(versions);
  }
  return Answer(text, machines.size() == 1 ? machines.front() : nlohmann::json{{"machines", machines}},
                options.json);
}

void AddHistoryCommand(CLI::App& model, const std::shared_ptr<ModelOptions>& options, int& exit_code) {
  CLI::App* command = model.add_subcommand(
      "history", "The versions of the model: how the error fell and the parameters moved");
  command->add_option("--machine,-m", options->machine, "Machine file (TOML)");
  command->add_option("--db,-d", options->change.history.db, "Database");
  command->add_option("--machine-name", options->change.history.machines,
                      "Machine of the database; all without it");
  AddJsonOption(*command, options->json);
  command->footer(
      "Examples:\n  hydroscope model history --machine press.toml\n  hydroscope model history --db press.db");
  RunsAs(*command, exit_code, [options] { return ShowHistory(*options); });
}

}  // namespace

void AddModelCommand(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<ModelOptions>();
  CLI::App* model =
      app.add_subcommand("model", "Effects of the library, and which are part of a machine's model");
  model->require_subcommand(1);
  model->footer(
      "Examples:\n  hydroscope model effects\n  hydroscope model add internal_leakage "
      "press.csv --machine press.toml\n"
      "  hydroscope model history --machine press.toml\n"
      "  hydroscope model promote --machine press.toml --db press.db");
  AddEffectsCommand(*model, options, exit_code);
  AddShowCommand(*model, options, exit_code);
  AddChangeCommand(*model, options, exit_code, "add", "Make an effect part of the model", WithEffect);
  AddChangeCommand(*model, options, exit_code, "remove", "Take an effect out of the model", WithoutEffect);
  AddUndoCommand(*model, options, exit_code);
  AddHistoryCommand(*model, options, exit_code);
  AddPromoteCommand(*model, options, exit_code);
}

}  // namespace hydroscope
