#include "studies/flexible_axis.h"

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>

#include "cli/command_answer.h"
#include "cli/machines/machines.h"
#include "cli/machines/simulated_log.h"
#include "cli/study_command.h"
#include "simulator/flexible_axis/log.h"

namespace hydroscope {
namespace {

struct FlexibleAxisArguments {
  SimulatedLogFiles files;
  std::string manoeuvre = "step";
  std::vector<std::string> effects;
  std::uint64_t random_machine = 0;
  FlexibleAxisOptions options;
};

nlohmann::json FlexibleAxisTruth(const FlexibleAxisOptions& o) {
  nlohmann::json parameters, noise;
  for (const auto& [name, size] : TrueParameters(o.machine)) parameters[name] = size;
  for (const auto& [name, size] : NoiseOf(o.sensors)) noise[name] = size;
  return {{"parameters", parameters},
          {"noise", noise},
          {"effects", FaultsJson(AllFlexibleAxisFaults(), o.faults)},
          {"seed", o.seed}};
}

Status RunFlexibleAxisSimulation(FlexibleAxisArguments a) {
  if (a.random_machine != 0) a.options.machine = RandomFlexibleAxis(a.random_machine);
  for (const AxisManoeuvreInfo& info : AllAxisManoeuvres())
    if (a.manoeuvre == info.name) a.options.manoeuvre = info.manoeuvre;
  for (const std::string& text : a.effects) TRY(TakeFault(text, AllFlexibleAxisFaults(), a.options.faults));
  TRY(Validate(a.options));
  return WriteSimulated(a.files, FormatFlexibleAxis(SimulateFlexibleAxis(a.options)),
                        FlexibleAxisTruth(a.options));
}

}  // namespace

void AddSimulateFlexibleAxis(CLI::App& simulate, int& exit_code) {
  CLI::App* app = simulate.add_subcommand("flexible-axis", "A servo axis with a flexible load: a log as CSV");
  app->option_defaults()->always_capture_default();
  auto a = std::make_shared<FlexibleAxisArguments>();
  std::vector<std::string> names;
  for (const AxisManoeuvreInfo& info : AllAxisManoeuvres()) names.emplace_back(info.name);
  FlexibleAxisOptions& o = a->options;
  AddFiles(*app, a->files);
  app->add_option("--manoeuvre", a->manoeuvre, "How it is driven")->check(CLI::IsMember(names));
  app->add_option("--effect", a->effects, "What is wrong with it, NAME or NAME=SIZE; repeatable");
  app->add_option("--random-machine", a->random_machine,
                  "Draw its parameters with this seed; 0: the published ones");
  app->add_option("--rows", o.rows, "Samples");
  app->add_option("--sample-period", o.period, "s");
  app->add_option("--filter", o.sensors.filter, "Hz, low-pass of first order in every sensor; 0 = none");
  app->add_option("--bits", o.sensors.bits, "Resolution of the converters; 0 = no steps");
  app->add_option("--coloured", o.sensors.coloured,
                  "How much of the noise remembers itself from row to row, 0 ... 1");
  app->add_option("--seed", o.seed, "Seed of the noise");
  app->footer(
      "Manoeuvres:\n" + NameLines(AllAxisManoeuvres()) + FaultLines(AllFlexibleAxisFaults()) +
      "Examples:\n"
      "  hydroscope simulate flexible-axis --out axis.csv --manoeuvre staircase --truth axis.json\n"
      "  hydroscope simulate flexible-axis --out air.csv --manoeuvre staircase --effect free_air=0.01");
  RunsAs(*app, exit_code, [a] { return RunFlexibleAxisSimulation(*a); });
}

void AddBenchmarkFlexibleAxis(CLI::App& benchmark, int& exit_code) {
  const auto [command, o] =
      AddStudy(benchmark, "flexible-axis",
               "Servo axis with a flexible load: random machines fitted from starts within a factor of ten",
               RunFlexibleAxisStudy, exit_code);
  command->add_option("--machines", o->machines, "Random machines")->check(CLI::PositiveNumber);
  command->add_option("--seed", o->seed, "Seed of the first");
  command->add_option("--starts", o->starts, "At most so many starts each")->check(CLI::PositiveNumber);
  command->add_flag("--effects", o->effects, "Hide each effect of the library in turn instead, and explain");
  command->add_option("--only", o->only, "... this one alone; - is the machine without any");
  command->footer(
      "Examples:\n"
      "  hydroscope benchmark flexible-axis\n"
      "  hydroscope benchmark flexible-axis --effects --machines 2");
}

}  // namespace hydroscope
