#include <CLI/CLI.hpp>
#include <memory>

#include "cli/command_answer.h"
#include "cli/machines/machines.h"
#include "host/text_sink.h"
#include "simulator/valve/valve_sweep.h"

namespace hydroscope {

void AddSimulateValve(CLI::App& simulate, int& exit_code) {
  CLI::App* app = simulate.add_subcommand("valve", "A servo valve under stepped sines: a sweep as CSV");
  app->option_defaults()->always_capture_default();
  auto out = std::make_shared<std::string>();
  auto o = std::make_shared<ValveSweepOptions>();
  app->add_option("--out", *out, "Sweep to write, .csv or .csv.gz; - is stdout")
      ->type_name("FILE")
      ->required();
  app->add_option("--frequencies", o->frequencies, "Hz, one after the other (10, 20 ... 160)")
      ->delimiter(',')
      ->default_str("");
  app->add_option("--f0", o->f0, "Natural frequency, Hz");
  app->add_option("--damping", o->damping, "Damping ratio");
  app->add_option("--gain", o->gain, "Spool position per (command / 10 V)");
  app->add_option("--dead-time", o->dead_time, "s");
  app->add_option("--amplitude", o->amplitude, "Share of full scale");
  app->add_option("--hold", o->hold, "Time at each frequency, s");
  app->add_option("--sample-rate", o->sample_rate, "Hz");
  app->add_option("--update-rate", o->update_rate, "Hz at which the command is refreshed; 0 = continuous");
  app->add_option("--noise", o->noise, "Standard deviation of the spool reading");
  app->add_option("--seed", o->seed, "Seed of the noise");
  app->footer(
      "Examples:\n"
      "  hydroscope simulate valve --out sweep.csv\n"
      "  hydroscope simulate valve --out worn.csv --f0 120 --damping 0.9 --dead-time 0.001 --sample-rate 4000");
  RunsAs(*app, exit_code, [out, o]() -> Status {
    TRY(Validate(*o));
    return WriteTextFile(*out, FormatValveSweep(SimulateValveSweep(*o)));
  });
}

}  // namespace hydroscope
