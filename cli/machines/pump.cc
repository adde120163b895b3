
#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>

#include "cli/command_answer.h"
#include "cli/machines/machines.h"
#include "cli/machines/simulated_log.h"
#include "cli/study_command.h"
#include "simulator/pump/log.h"
#include "studies/pump/benchmark.h"

namespace hydroscope {
namespace {

struct PumpArguments {
  SimulatedLogFiles files;
  std::string manoeuvre = "levels";
  std::vector<std::string> effects;
  std::uint64_t random_machine = 0;
  PumpOptions options;
};

nlohmann::json PumpTruth(const PumpOptions& o, const PumpLog& log) {
  nlohmann::json parameters;
  for (const auto& [name, size] : TrueParameters(o)) parameters[name] = size;
  return {{"parameters", parameters},
          {"effects", FaultsJson(AllPumpFaults(), o.faults)},
          {"ripple_rms", log.RippleRms()},
          {"seed", o.seed}};
}

Status RunPumpSimulation(const PumpArguments& a, const CLI::App& app) {
  PumpOptions o = a.options;
  if (a.random_machine != 0) {
    const PumpOptions drawn = RandomPump(a.random_machine);
    o.machine = drawn.machine;
    if (app.count("--preload") > 0) o.machine.preload = a.options.machine.preload;
    if (app.count("--flow-lag") == 0) o.sensors.flow_lag = drawn.sensors.flow_lag;
    if (app.count("--speed") == 0) o.speed = drawn.speed;
  }
  for (const PumpManoeuvreInfo& info : AllPumpManoeuvres())
    if (a.manoeuvre == info.name) o.manoeuvre = info.manoeuvre;
  for (const std::string& text : a.effects) TRY(TakeFault(text, AllPumpFaults(), o.faults));
  TRY(Validate(o));
  const PumpLog log = SimulatePump(o);
  return WriteSimulated(a.files, FormatPump(log), PumpTruth(o, log));
}

}  // namespace

void AddSimulatePump(CLI::App& simulate, int& exit_code) {
  CLI::App* app =
      simulate.add_subcommand("pump", "A pressure-compensated pump of variable displacement: a log as CSV");
  app->option_defaults()->always_capture_default();
  auto a = std::make_shared<PumpArguments>();
  std::vector<std::string> names;
  for (const PumpManoeuvreInfo& info : AllPumpManoeuvres()) names.emplace_back(info.name);
  PumpOptions& o = a->options;
  AddFiles(*app, a->files);
  app->add_option("--manoeuvre", a->manoeuvre, "How it is driven")->check(CLI::IsMember(names));
  app->add_option("--effect", a->effects, "What is wrong with it, NAME or NAME=SIZE; repeatable")
      ->allow_extra_args(false);
  app->add_option("--random-machine", a->random_machine,
                  "Draw its parameters with this seed; 0: the usual ones");
  app->add_option("--seconds", o.seconds, "Length in s");
  app->add_option("--sample-period", o.period, "s");
  app->add_option("--speed", o.speed, "rad/s of the shaft, its highest");
  app->add_option("--speed-swing", o.speed_swing, "Share of the speed that it wanders by");
  app->add_option("--ripple", o.ripple, "Ripple of the pistons, relative to the usual; 0 = none");
  app->add_option("--preload", o.machine.preload, "N, of the compensator spring");
  app->add_option("--flow-lag", o.sensors.flow_lag, "s, time constant of the flow sensor");
  app->add_option("--wear", o.wear, "Share per s by which the leakage of the control chamber grows");
  app->add_option("--wear-from", o.wear_from, "... from this time on, s");
  app->add_option("--seed", o.seed, "Seed of noise, load and pistons");
  app->footer("Manoeuvres:\n" + NameLines(AllPumpManoeuvres()) + FaultLines(AllPumpFaults()) +
              "Examples:\n"
              "  hydroscope simulate pump --out pump.csv --truth pump.json\n"
              "  hydroscope simulate pump --out sticky.csv --effect sticking_spool\n"
              "  hydroscope simulate pump --out pulse.csv --manoeuvre pulse --seed 2");
  RunsAs(*app, exit_code, [a, app] { return RunPumpSimulation(*a, *app); });
}

void AddBenchmarkPump(CLI::App& benchmark, int& exit_code) {
  const auto [command, o] = AddStudy(
      benchmark, "pump",
      "Random pumps with ripple and noise fitted beside the published linear model; hidden effects named",
      RunPumpBenchmark, exit_code);
  command->add_option("--machines", o->machines, "Random pumps")->check(CLI::PositiveNumber);
  command->add_option("--effects", o->effects, "Logs with each hidden effect, and without one; 0 = none")
      ->check(CLI::NonNegativeNumber);
  command->add_option("--seed", o->seed, "Seed of the whole campaign");
  AddJobs(*command, o->threads);
  command->footer(
      "Examples:\n"
      "  hydroscope benchmark pump\n"
      "  hydroscope benchmark pump --machines 3 --effects 0");
}

}  // namespace hydroscope
