#include <CLI/CLI.hpp>
#include <memory>

#include "cli/command_answer.h"
#include "cli/machines/live_command.h"
#include "cli/machines/machines.h"
#include "cli/machines/press_log.h"
#include "cli/machines/press_settings.h"
#include "cli/machines/served_press.h"
#include "simulator/die_cushion/live_press.h"

namespace hydroscope {
namespace {

struct PressArguments {
  std::string out, machine, oil, truth;
  std::vector<std::string> effects, imperfections, faults;
  PressOptions options;
  double speed_min = 20, speed_max = 120;  // mm/s
  double noise_factor = 1;
  std::uint64_t random_machine = 0;
  int adc_bits = 0, cylinders = 1, effect_cylinder = 0;
  bool speed_given = false, list_effects = false, list_imperfections = false;
  ServedPress serve;
  bool seconds_given = false, period_given = false;
};

/// Everything the command line says, as options of one cylinder.
Result<PressOptions> BuildOptions(const PressArguments& a) {
  PressOptions o = a.options;
  if (a.random_machine != 0) {
    const PressOptions drawn = RandomMachine(a.random_machine);
    o.machine = drawn.machine;
    o.motion = drawn.motion;
  }
  if (!a.machine.empty()) TRY(TakeMachine(a.machine, o));
  if (a.random_machine == 0 || a.speed_given) {
    o.motion.speed_min = a.speed_min / 1e3;
    o.motion.speed_max = a.speed_max / 1e3;
  }
  if (!a.oil.empty()) TRY(ParseOil(a.oil, o));
  for (const std::string& text : a.effects) {
    const auto effect = TRY(ParseEffect(text));
    o.effects.push_back(effect);
  }
  for (const std::string& text : a.imperfections) {
    const auto imperfection = TRY(ParseImperfection(text));
    o.imperfections.push_back(imperfection);
  }
  for (const std::string& text : a.faults) {
    const auto fault = TRY(ParseFault(text));
    o.faults.push_back(fault);
  }
  for (double* std : {&o.noise.p_A, &o.noise.p_B, &o.noise.p_0, &o.noise.z, &o.noise.y_v, &o.noise.T_oil})
    *std *= a.noise_factor;
  if (a.adc_bits > 0) o.quantum = QuantumOfBits(a.adc_bits);
  TRY(Validate(o));
  return o;
}

/// "press.csv", cylinder 2 of several: "press_2.csv"; "press.csv.gz": "press_2.csv.gz".
std::string NameOfCylinder(const std::string& path, int cylinder, int cylinders) {
  if (cylinders == 1 || path == "-") return path;
  const auto slash = path.find_last_of('/');
  const auto dot = path.find('.', slash == std::string::npos ? 0 : slash + 1);
  const std::string number = fmt::format("_{}", cylinder);
  return dot == std::string::npos ? path + number : path.substr(0, dot) + number + path.substr(dot);
}

/// Endless and at 1 kHz unless the command line says otherwise.
Status RunServe(const PressArguments& a) {
  if (!a.imperfections.empty())
    return UsageError("--imperfection is for logs; a press that is served takes faults and effects");
  auto options = TRY(BuildOptions(a));
  if (!a.seconds_given) options.seconds = 1e8;
  if (!a.period_given) options.sample_period = 1e-3;
  return ServePress(a.serve, options);
}

Status RunPress(const PressArguments& a) {
  if (a.list_effects) {
    Say(EffectTable());
    return {};
  }
  if (a.list_imperfections) {
    Say(ImperfectionTable());
    return {};
  }
  if (!a.serve.machine.empty()) return RunServe(a);
  if (a.out.empty()) return UsageError("--out FILE is missing: where shall the log go? ('-' is stdout)");
  if (a.cylinders > 1 && a.out == "-")
    return UsageError("--cylinders 4 writes four files; --out cannot be '-'");
  const auto options = TRY(BuildOptions(a));
  if (a.cylinders == 1) return WritePressLog(options, a.out, a.truth);
  const auto cushions = FourCushions(options);
  for (int k = 1; k <= a.cylinders; ++k) {
    PressOptions cushion = cushions[k - 1];
    if (a.effect_cylinder != 0 && k != a.effect_cylinder) cushion.effects.clear();
    const std::string truth = a.truth.empty() ? "" : NameOfCylinder(a.truth, k, a.cylinders);
    TRY(WritePressLog(cushion, NameOfCylinder(a.out, k, a.cylinders), truth));
  }
  return {};
}

void AddHiddenOptions(CLI::App& app, PressArguments& a) {
  app.add_option("--effect", a.effects, "Hidden effect ID[=SIZE][,NAME=VALUE...] in SI, repeatable")
      ->type_name("EFFECT")
      ->allow_extra_args(false);
  app.add_flag("--list-effects", a.list_effects, "Print the effects with units and typical sizes");
  app.add_option("--imperfection", a.imperfections,
                 "What plants have and simulations lack: "
                 "KIND[=SIZE][,NAME=VALUE...][,on=CHANNEL] in SI, repeatable")
      ->type_name("KIND")
      ->allow_extra_args(false);
  app.add_flag("--list-imperfections", a.list_imperfections,
               "Print the imperfections with units and typical sizes");
}

void AddMachineOptions(CLI::App& app, PressArguments& a) {
  app.add_option("--speed-min", a.speed_min, "Lowest ram speed, mm/s")->capture_default_str();
  app.add_option("--speed-max", a.speed_max, "Highest ram speed, mm/s; equal: constant")
      ->capture_default_str();
  app.add_option("--oil", a.oil, "Oil temperature START:END in degC (40 if not given)")->type_name("T0:T1");
  app.add_option("--machine", a.machine, "Take A_A, dp_nom and p_t from a machine file")->type_name("FILE");
  app.add_option("--random-machine", a.random_machine, "Draw a machine with this seed (above 0)");
  app.add_option("--cylinders", a.cylinders, "4: four cylinders of one press, FILE_1 ... FILE_4")
      ->check(CLI::IsMember({1, 4}));
  app.add_option("--effect-cylinder", a.effect_cylinder, "Hide the effects in this cylinder only")
      ->check(CLI::Range(1, 4));
}

void AddSensorOptions(CLI::App& app, PressArguments& a) {
  app.add_option(
         "--fault", a.faults,
         "Sensor fault kind:channel:start:duration[:size], repeatable; kind nan, stuck, spike, dropout, "
         "offset_drift, clock_jump; s and SI")
      ->type_name("FAULT")
      ->allow_extra_args(false);
  app.add_option("--noise", a.noise_factor, "Sensor noise relative to the rig's; 0 = none")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 1e5));
  app.add_option("--hum", a.options.noise.hum_amplitude, "Mains hum on p_A, Pa")->check(CLI::Range(0.0, 1e8));
  app.add_option("--adc-bits", a.adc_bits, "Resolution of the converters")->check(CLI::Range(8, 24));
  app.add_option("--sample-period", a.options.sample_period, "s; --serve: 0.001 if not given")
      ->capture_default_str();
}

void AddServeOptions(CLI::App& app, ServedPress& serve) {
  app.add_option("--serve", serve.machine,
                 "Serve the press of this machine file by DDS and Modbus in place of writing a log")
      ->type_name("FILE");
  app.add_option("--axes", serve.axes, "--serve: cylinders, if not as many as the machine file names")
      ->check(CLI::Range(1, LivePress::kMostAxes));
  app.add_option("--speed", serve.speed, "--serve: times real time")
      ->check(CLI::Range(0.01, 1000.0))
      ->capture_default_str();
  app.add_option("--work", serve.work, "--serve: s of work before each pause; 0 = no pauses")
      ->check(CLI::Range(0.0, 1e5))
      ->capture_default_str();
  app.add_option("--pause", serve.pause, "--serve: s of rest after each work")
      ->check(CLI::Range(0.0, 1e5))
      ->capture_default_str();
  app.add_option("--clock-drift", serve.clock_drift, "--serve: the press's clock runs faster, ppm")
      ->check(CLI::Range(-1e5, 1e5))
      ->capture_default_str();
}

}  // namespace

void AddSimulatePress(CLI::App& simulate, int& exit_code) {
  CLI::App* app =
      simulate.add_subcommand("press", "A die-cushion cylinder of a deep-drawing press: a log as CSV");
  auto a = std::make_shared<PressArguments>();
  PressOptions& o = a->options;
  app->add_option("--out", a->out, "Log to write, .csv or .csv.gz; - is stdout")->type_name("FILE");
  app->add_option("--seconds", o.seconds, "Length in s; --serve: of the press's time, endless if not given")
      ->capture_default_str();
  app->add_option("--seed", o.seed, "Seed of motion, set points and noise")->capture_default_str();
  app->add_option("--noise-seed", o.noise_seed, "Other noise over the same motion");
  AddHiddenOptions(*app, *a);
  AddMachineOptions(*app, *a);
  AddSensorOptions(*app, *a);
  app->add_option("--truth", a->truth, "Write the true parameters and strokes as JSON")->type_name("FILE");
  AddServeOptions(*app, a->serve);
  app->footer(
      "While it serves, lines on stdin change the press; each is answered with ok or error:\n" +
      LiveCommandHelp() +
      "\nExamples:\n"
      "  hydroscope simulate press --out press.csv --seconds 120 --seed 1\n"
      "  hydroscope simulate press --out leak.csv --effect internal_leakage=4e-12 --truth leak.json\n"
      "  hydroscope simulate press --out relief.csv.gz --effect relief_valve=2e-11,crack=170e5 --oil 26:52\n"
      "  hydroscope simulate press --out filtered.csv --imperfection coloured_noise=0.1,phi=0.8\n"
      "  hydroscope simulate press --out lag.csv --imperfection pressure_signal_lag=0.004\n"
      "  hydroscope simulate press --out slow.csv --speed-min 50 --speed-max 50\n"
      "  hydroscope simulate press --out bad.csv --fault stuck:p_A:30:2 --fault clock_jump:t:60:0:3600\n"
      "  hydroscope simulate press --out c.csv --cylinders 4 --effect external_leakage --effect-cylinder 2\n"
      "  hydroscope simulate press --serve machines/press_live.toml\n"
      "  (sleep 60; echo 'effect internal_leakage=4e-12 axis=2 ramp=600'; sleep 3600) |\n"
      "      hydroscope simulate press --serve machines/press_live.toml --work 60 --pause 20");
  RunsAs(*app, exit_code, [a, app] {
    a->seconds_given = app->count("--seconds") > 0;
    a->period_given = app->count("--sample-period") > 0;
    a->speed_given = app->count("--speed-min") + app->count("--speed-max") > 0;
    return RunPress(*a);
  });
}

}  // namespace hydroscope
