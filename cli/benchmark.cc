#include <CLI/CLI.hpp>

#include "cli/commands.h"
#include "cli/machines/machines.h"
#include "cli/study_command.h"
#include "studies/benchmarks.h"
#include "studies/drift/drift_benchmarks.h"
#include "studies/own_machines.h"
#include "studies/plant_logs_benchmark.h"
#include "studies/recovery.h"
#include "studies/seal_friction.h"
#include "studies/state_machines.h"

namespace hydroscope {
namespace {

void AddCoverage(CLI::App& benchmark, int& exit_code) {
  const auto [command, o] =
      AddStudy(benchmark, "coverage", "How often the 95 % intervals of the fit hold the truth",
               RunCoverageBenchmark, exit_code);
  command->add_option("--cases", o->cases, "Simulated machines, each with its own parameters")
      ->check(CLI::PositiveNumber);
  command->add_option("--seconds", o->seconds, "Length of each log, s")->check(CLI::Range(10.0, 1e5));
  command->add_option("--seed", o->seed, "Seed of the first machine");
  command->footer("Example:\n  hydroscope benchmark coverage --cases 200 --seconds 120");
}

void AddFrf(CLI::App& benchmark, int& exit_code) {
  const auto [command, o] = AddStudy(benchmark, "frf", "Valve model from simulated sweeps against the truth",
                                     RunFrfBenchmark, exit_code);
  command->add_option("--cases", o->cases, "Noise draws per variation")->check(CLI::PositiveNumber);
  command->add_option("--seed", o->seed, "Seed of the first draw");
  command->footer("Example:\n  hydroscope benchmark frf --cases 100");
}

void AddLateSignals(CLI::App& benchmark, int& exit_code) {
  const auto [command, o] =
      AddStudy(benchmark, "late-signals",
               "Late signals and filtered ones: how often they are told apart, and how far each is right",
               RunLateSignalsBenchmark, exit_code);
  command->add_option("--cases", o->cases, "Simulated logs")->check(CLI::PositiveNumber);
  command->add_option("--seed", o->seed, "Seed of the whole campaign");
  command->footer("Example:\n  hydroscope benchmark late-signals --cases 48");
}

void AddHiddenEffects(CLI::App& benchmark, int& exit_code) {
  const auto [command, o] =
      AddStudy(benchmark, "hidden-effects",
               "Effects hidden in simulated logs: how often they are found, and how often wrongly named",
               RunHiddenEffectsBenchmark, exit_code);
  command->add_option("--cases", o->cases, "Simulated logs of 60 ... 180 s")->check(CLI::PositiveNumber);
  command->add_option("--seed", o->seed, "Seed of the whole campaign");
  command->add_flag(
      "--experiments", o->experiments,
      "Also run the experiment proposed for each ambiguous log in the simulator and explain again");
  command->add_option("--only", o->only, "Only these logs of the campaign, by number")
      ->delimiter(',')
      ->check(CLI::NonNegativeNumber);
  command->add_flag("--healthy", o->healthy, "Hide nothing: how often something is claimed all the same");
  command->add_option("--details", o->details, "Write one line per log to this tab-separated file");
  command->footer(
      "Examples:\n"
      "  hydroscope benchmark hidden-effects --cases 300\n"
      "  hydroscope benchmark hidden-effects --cases 300 --seed 5 --experiments\n"
      "  hydroscope benchmark hidden-effects --cases 40 --seed 7 --details cases.tsv");
}

void AddPlantLogs(CLI::App& benchmark, int& exit_code) {
  const auto [command, o] = AddStudy(benchmark, "plant-logs",
                                     "Logs as plants have them, each with an imperfection: right, "
                                     "wrong and missing answers of explain and fit",
                                     RunPlantLogsBenchmark, exit_code);
  command->add_option("--cases", o->cases, "Simulated logs of 60 ... 180 s")->check(CLI::PositiveNumber);
  command->add_option("--first", o->first, "Number of the first log, to have one of a campaign again")
      ->check(CLI::NonNegativeNumber);
  command->add_option("--seed", o->seed, "Seed of the whole campaign");
  command->add_option("--kinds", o->kinds, "Only these kinds of imperfection, separated by commas")
      ->delimiter(',');
  command->add_option("--further", o->further, "So many imperfections of other kinds in each log besides")
      ->check(CLI::Range(0, 4));
  AddJobs(*command, o->threads);
  command->add_option("--details", o->details, "Write one line per log to this tab-separated file");
  command->footer(
      "Examples:\n"
      "  hydroscope benchmark plant-logs\n"
      "  hydroscope benchmark plant-logs --further 2 --cases 120\n"
      "  hydroscope benchmark plant-logs --cases 40 --kinds coloured_noise,signal_lag --details cases.tsv\n"
      "  hydroscope benchmark plant-logs --seed 7 --first 123 --cases 1");
}

void AddSince(CLI::App& benchmark, int& exit_code) {
  const auto [command, o] =
      AddStudy(benchmark, "since",
               "What changed at a known time, by 'explain --since': right, wrong and superfluous names",
               RunSinceBenchmark, exit_code);
  command->add_option("--cases", o->cases, "Histories of simulated machines, a log before and one after")
      ->check(CLI::PositiveNumber);
  command->add_option("--seed", o->seed, "Seed of the whole campaign");
  command->add_option("--effect", o->effect, "Where one effect appears, this one");
  command->add_option("--details", o->details, "Write one line per history to this tab-separated file");
  command->footer(
      "Examples:\n"
      "  hydroscope benchmark since\n"
      "  hydroscope benchmark since --cases 30 --effect relief_valve --details cases.tsv");
}

void AddFilterStudy(CLI::App& benchmark, int& exit_code) {
  const auto [command, o] =
      AddStudy(benchmark, "filter-study",
               "The press paper's filter study: its estimator over filter widths, and ours beside it",
               RunFilterStudy, exit_code);
  command->add_option("--draws", o->draws, "Noise draws of the one simulated log")
      ->check(CLI::Range(2, 100000));
  command->add_option("--seconds", o->seconds, "Length of the log, s")->check(CLI::Range(20.0, 1e4));
  command->add_option("--seed", o->seed, "Seed of the log and of the first draw");
  command->add_option("--seeds", o->seeds, "Logs: repeat ours on this many, with the median over them")
      ->check(CLI::Range(1, 1000));
  command->add_option("--svg", o->svg,
                      "Write a plot of bias and standard deviation over the width to this file");
  command->footer(
      "Examples:\n"
      "  hydroscope benchmark filter-study\n"
      "  hydroscope benchmark filter-study --seeds 20\n"
      "  hydroscope benchmark filter-study --draws 20 --svg filter_study.svg");
}

void AddThirtyRuns(CLI::App& benchmark, int& exit_code) {
  const auto [command, o] =
      AddStudy(benchmark, "thirty-runs",
               "Consecutive runs while the oil warms up: Q_vn must follow, K' and V0 must not", RunThirtyRuns,
               exit_code);
  command->add_option("--runs", o->runs, "Number of runs")->check(CLI::Range(6, 10000));
  command->add_option("--seconds", o->seconds, "Length of each run, s")->check(CLI::Range(10.0, 1e4));
  command->add_option("--viscosity", o->viscosity, "True change of the valve's flow with the oil, 1/K")
      ->check(CLI::Range(-1.0, 1.0));
  command->add_option("--seed", o->seed, "Seed of all runs");
  command->add_option("--seeds", o->seeds, "Repeat with this many seeds and list the slopes")
      ->check(CLI::Range(1, 1000));
  command->add_option("--db", o->database, "Keep the trend database of the first seed in this new file");
  command->add_option("--report", o->report, "Write the report of the first seed to this HTML file");
  command->footer(
      "Examples:\n"
      "  hydroscope benchmark thirty-runs --db runs.db --report runs.html\n"
      "  hydroscope benchmark thirty-runs --seeds 20");
}

void AddRecovery(CLI::App& benchmark, int& exit_code) {
  const auto [command, o] =
      AddStudy(benchmark, "recovery",
               "Each effect of the library simulated at a known size: found again by the extended model?",
               RunRecovery, exit_code);
  command->add_option("--seconds", o->seconds, "Length of each log, s")->check(CLI::Range(30.0, 1e4));
  command->add_option("--seed", o->seed, "Seed of the first log of each effect");
  command->add_option("--seeds", o->seeds, "Logs per effect")->check(CLI::Range(1, 1000));
  command->add_option("--effect", o->effect, "Only this one");
  command->add_flag("--random", o->random, "Machines, sizes and shapes drawn at random, off every grid");
  command->footer(
      "Examples:\n"
      "  hydroscope benchmark recovery\n"
      "  hydroscope benchmark recovery --random --seeds 20\n"
      "  hydroscope benchmark recovery --effect pressure_signal_delay\n"
      "  hydroscope benchmark recovery --seeds 10");
}

void AddEndurance(CLI::App& benchmark, int& exit_code) {
  const auto [command, o] =
      AddStudy(benchmark, "endurance", "Millions of updates and a day of standstill: nothing may drift",
               RunEndurance, exit_code);
  command->add_option("--updates", o->updates, "Updates of each form of forgetting")
      ->check(CLI::Range(std::int64_t{1000}, std::int64_t{1'000'000'000'000}));
  command->add_option("--hours", o->standstill_hours, "Hours of standstill")->check(CLI::Range(0.01, 1e4));
  command->add_option("--seed", o->seed, "Seed");
  command->footer(
      "Examples:\n"
      "  hydroscope benchmark endurance\n"
      "  hydroscope benchmark endurance --updates 1000000 --hours 1");
}

void AddDrift(CLI::App& benchmark, int& exit_code) {
  const auto [command, o] = AddStudy(
      benchmark, "drift",
      "Drift detection: false alarms of a healthy press, delay and naming of faults, faults under a warm-up",
      RunDriftBenchmark, exit_code);
  command->add_option("--axis-years", o->axis_years, "Healthy axis-years of 365 days of 1 500 strokes")
      ->check(CLI::Range(0.001, 1000.0));
  command->add_option("--faults", o->faults, "Cases of each fault")->check(CLI::Range(1, 100000));
  command->add_option("--seed", o->seed, "Seed of the whole campaign");
  command->footer(
      "Examples:\n"
      "  hydroscope benchmark drift\n"
      "  hydroscope benchmark drift --axis-years 0.1 --faults 20");
}

void AddDriftFull(CLI::App& benchmark, int& exit_code) {
  const auto [command, o] = AddStudy(
      benchmark, "drift-full",
      "Drift detection on fully simulated logs of machines at random, every stroke through the pipeline",
      RunDriftFullSimulation, exit_code);
  command->add_option("--machines", o->machines, "Machines, every second one with three products")
      ->check(CLI::Range(1, 10000));
  command->add_option("--commissioning", o->commissioning, "Strokes the reference is learned from")
      ->check(CLI::Range(100, 100000));
  command->add_option("--learned-to", o->learned_to, "Warmest oil while the reference is learned, degC")
      ->check(CLI::Range(24.0, 100.0));
  command->add_option("--healthy", o->healthy, "Healthy strokes judged on each machine")
      ->check(CLI::Range(1, 1000000));
  command->add_option("--faulty", o->faulty, "Strokes of each fault")->check(CLI::Range(1, 100000));
  command->add_option("--seed", o->seed, "Seed of the whole campaign");
  command->add_flag("--details", o->details, "Print what was found on each machine");
  command->footer(
      "Examples:\n"
      "  hydroscope benchmark drift-full\n"
      "  hydroscope benchmark drift-full --machines 2 --healthy 300 --details");
}

void AddSealFriction(CLI::App& benchmark, int& exit_code) {
  const auto [command, o] =
      AddStudy(benchmark, "seal-friction",
               "Measured runs of a cylinder seal: from F = A p + c to the friction that is missing",
               RunSealFriction, exit_code);
  command->add_option(
      "--data", o->data,
      "Folder with the runs (*.csv); without it seal_friction in HYDROSCOPE_DATA or ../shared/data");
  command->add_option("--machine,-m", o->machine, "Machine file (TOML)");
  command->footer(
      "Examples:\n"
      "  hydroscope benchmark seal-friction\n"
      "  hydroscope benchmark seal-friction --data runs --machine machines/seal_friction.toml");
}

void AddOwnMachines(CLI::App& benchmark, int& exit_code) {
  const auto [command, o] =
      AddStudy(benchmark, "own-machines",
               "Effects hidden in simulated machines of the user's own, among eight that are alike",
               RunOwnMachines, exit_code);
  command->add_option("--cases", o->cases, "Simulated machines")->check(CLI::PositiveNumber);
  command->add_option("--seed", o->seed, "Seed of the first machine");
  command->footer("Example:\n  hydroscope benchmark own-machines --cases 60");
}

void AddStateMachines(CLI::App& benchmark, int& exit_code) {
  const auto [command, o] = AddStudy(benchmark, "state-machines",
                                     "Effects hidden in simulated machines that are described by states",
                                     RunStateMachines, exit_code);
  command->add_option("--cases", o->cases, "Simulated machines")->check(CLI::PositiveNumber);
  command->add_option("--first", o->first, "Number of the first of them")->check(CLI::NonNegativeNumber);
  command->add_option("--seed", o->seed, "Seed of the machines");
  AddJobs(*command, o->threads);
  command->footer("Example:\n  hydroscope benchmark state-machines --cases 36");
}

void AddExampleLog(CLI::App& benchmark, int& exit_code) {
  const auto [command, o] = AddStudy(
      benchmark, "example-log", "Fit of an example log against its known truth", RunExampleLog, exit_code);
  o->machine_file = "machines/die_cushion.toml";
  command->add_option("LOG", o->log, "Log without hidden effect (CSV, CSV.gz or MAT)")->required();
  command->add_option("--machine,-m", o->machine_file, "Machine file (TOML)");
  command->add_option("--K", o->K, "True bulk modulus, Pa")->check(CLI::Range(1e6, 1e12));
  command->add_option("--V0", o->V0, "True dead volume, m3")->check(CLI::Range(1e-6, 10.0));
  command->add_option("--Q_vn", o->Q_vn, "True nominal flow of the valve, m3/s (102 l/min = 0.0017)")
      ->check(CLI::Range(1e-9, 10.0));
  command->add_option("--y_0", o->y_0, "True spool position without flow")->check(CLI::Range(-1.0, 1.0));
  command->footer(
      "Examples:\n"
      "  hydroscope benchmark example-log log_a.csv\n"
      "  hydroscope benchmark example-log press.csv --K 1.3e9 --V0 0.0017");
}

}  // namespace

void AddBenchmarkCommand(CLI::App& app, int& exit_code) {
  CLI::App* benchmark =
      app.add_subcommand("benchmark", "Studies on simulated machines, whose truth is known");
  benchmark->require_subcommand(1);
  benchmark->option_defaults()->always_capture_default();
  benchmark->footer(
      "Every study prints a table, says what was required, and returns 0 if it was reached, else 1.\n"
      "Examples:\n"
      "  hydroscope benchmark coverage --cases 200\n"
      "  hydroscope benchmark filter-study --svg filter_study.svg");
  AddCoverage(*benchmark, exit_code);
  AddHiddenEffects(*benchmark, exit_code);
  AddLateSignals(*benchmark, exit_code);
  AddPlantLogs(*benchmark, exit_code);
  AddSince(*benchmark, exit_code);
  AddFrf(*benchmark, exit_code);
  AddFilterStudy(*benchmark, exit_code);
  AddThirtyRuns(*benchmark, exit_code);
  AddRecovery(*benchmark, exit_code);
  AddEndurance(*benchmark, exit_code);
  AddDrift(*benchmark, exit_code);
  AddDriftFull(*benchmark, exit_code);
  AddExampleLog(*benchmark, exit_code);
  AddLiveBenchmarks(*benchmark, exit_code);
  AddAlarmBenchmarks(*benchmark, exit_code);
  AddSealFriction(*benchmark, exit_code);
  AddOwnMachines(*benchmark, exit_code);
  AddStateMachines(*benchmark, exit_code);
#define HYDROSCOPE_ADD_BENCHMARK(Name) AddBenchmark##Name(*benchmark, exit_code);
  HYDROSCOPE_SIMULATED_MACHINES(HYDROSCOPE_ADD_BENCHMARK)
#undef HYDROSCOPE_ADD_BENCHMARK
}

}  // namespace hydroscope
