#include "simulator/manipulator/manipulator.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>

#include "cli/command_answer.h"
#include "cli/machines/machines.h"
#include "cli/machines/simulated_log.h"
#include "cli/study_command.h"
#include "studies/manipulator/benchmark.h"

namespace hydroscope {
namespace {

struct ManipulatorArguments {
  SimulatedLogFiles files;
  std::string motion = "series", control = "datasheet";
  std::vector<std::string> effects;
  ManipulatorOptions options;
  std::uint64_t random_machine = 0, motion_seed = 1;
  double noise_factor = 1;
  bool list_effects = false;
};

std::string EffectLines() {
  std::string text = "effect                unit  typical  law\n";
  for (const ManipulatorEffectInfo& e : ManipulatorEffects())
    text += fmt::format("{:<21} {:<5} {:<8g} {}\n", e.id, e.unit, e.typical_size, e.law);
  return text;
}

Result<ManipulatorOptions> ManipulatorOptionsOf(const ManipulatorArguments& a) {
  ManipulatorOptions o = a.options;
  if (a.random_machine != 0) o.truth = DrawnManipulator(a.random_machine);
  o.motion = a.motion == "series" ? DrawnMotion(a.motion_seed) : ParallelogramMotion();
  for (const std::string& effect : a.effects) TRY(HideEffect(effect, o.truth));
  o.model = a.control == "true" ? TrueModel(o.truth) : DatasheetModel(o.truth);
  for (double* std : {&o.noise.q, &o.noise.p, &o.noise.spool}) *std *= a.noise_factor;
  TRY(Validate(o));
  return o;
}

nlohmann::json ManipulatorTruthOf(const ManipulatorOptions& o, const std::vector<std::string>& effects,
                                  const TrackingError& tracking) {
  nlohmann::json parameters;
  for (const auto& [name, value] : TrueParameters(o.truth)) parameters[name] = value;
  return {
      {"machine", "manipulator"},
      {"parameters", parameters},
      {"effects", effects},
      {"tracking",
       {{"rms_m", tracking.rms}, {"max_m", tracking.largest}, {"max_speed_m_s", tracking.largest_speed}}}};
}

Status RunSimulation(const ManipulatorArguments& a) {
  if (a.list_effects) {
    Say(EffectLines());
    return {};
  }
  if (a.files.out.empty())
    return UsageError("--out FILE is missing: where shall the log go? ('-' is stdout)");
  const auto options = TRY(ManipulatorOptionsOf(a));
  const ManipulatorLog log = SimulateManipulator(options);
  std::string text = kManipulatorLogHeader;
  for (const ManipulatorRow& row : log.rows) AppendManipulatorLine(row, text);
  return WriteSimulated(a.files, text, ManipulatorTruthOf(options, a.effects, log.tracking));
}

}  // namespace

void AddSimulateManipulator(CLI::App& simulate, int& exit_code) {
  CLI::App* app = simulate.add_subcommand(
      "manipulator", "An arm of two joints, driven by cylinders with four-edge valves: a log as CSV");
  app->option_defaults()->always_capture_default();
  auto a = std::make_shared<ManipulatorArguments>();
  ManipulatorOptions& o = a->options;
  app->add_option("--out", a->files.out, "Log to write, .csv or .csv.gz; - is stdout")->type_name("FILE");
  app->add_option("--seconds", o.seconds, "Length in s");
  app->add_option("--seed", o.seed, "Seed of the noise");
  app->add_option("--motion", a->motion,
                  "series: both joints through their ranges; parallelogram: the paper's path")
      ->check(CLI::IsMember({"series", "parallelogram"}));
  app->add_option("--motion-seed", a->motion_seed, "Seed of the series");
  app->add_option("--control", a->control, "What the controller believes: datasheet and CAD, or the truth")
      ->check(CLI::IsMember({"datasheet", "true"}));
  app->add_option("--effect", a->effects, "Hidden effect ID[=SIZE] in SI, repeatable")
      ->type_name("EFFECT")
      ->allow_extra_args(false);
  app->add_flag("--list-effects", a->list_effects, "Print the effects with units and typical sizes");
  app->add_option("--random-machine", a->random_machine, "Draw a machine with this seed; 0: the usual one");
  app->add_option("--noise", a->noise_factor, "Sensor noise relative to the usual; 0 = none")
      ->check(CLI::Range(0.0, 1e5));
  app->add_option("--sample-period", o.sample_period, "s");
  app->add_option("--truth", a->files.truth,
                  "Write the true parameters and how well the arm followed as JSON")
      ->type_name("FILE");
  app->footer(
      "Examples:\n"
      "  hydroscope simulate manipulator --out arm.csv --truth arm.json\n"
      "  hydroscope simulate manipulator --out heavy.csv --effect payload=80\n"
      "  hydroscope simulate manipulator --out path.csv --motion parallelogram --control true --seconds 27");
  RunsAs(*app, exit_code, [a] { return RunSimulation(*a); });
}

void AddBenchmarkManipulator(CLI::App& benchmark, int& exit_code) {
  const auto [command, o] = AddStudy(
      benchmark, "manipulator",
      "Parameters of simulated manipulators against their truth; how well the arm follows the paper's path with them",
      RunManipulatorBenchmark, exit_code);
  command->add_option("--cases", o->cases, "Drawn machines that are identified, 0 = none: effects alone")
      ->check(CLI::NonNegativeNumber);
  command->add_option("--seconds", o->seconds, "Length of each record, s")->check(CLI::Range(20.0, 3600.0));
  command->add_option("--effects", o->effects, "Logs with a hidden effect to explain, 0 = none")
      ->check(CLI::NonNegativeNumber);
  command
      ->add_option("--first-effect", o->first_effect,
                   "Number of the first of these logs: effects in turn, then a healthy log")
      ->check(CLI::NonNegativeNumber);
  AddJobs(*command, o->threads);
  command->add_option("--seed", o->seed, "Seed of the whole campaign");
  command->footer(
      "Examples:\n"
      "  hydroscope benchmark manipulator\n"
      "  hydroscope benchmark manipulator --cases 0 --effects 28");
}

}  // namespace hydroscope
