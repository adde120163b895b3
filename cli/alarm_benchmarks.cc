// `hydroscope benchmark alarm-...`: campaigns of the alarm journal and its feeds.

#include "studies/alarms/alarm_benchmarks.h"

#include <CLI/CLI.hpp>

#include "cli/commands.h"
#include "cli/study_command.h"

namespace hydroscope {
namespace {

void AddAlarmKill(CLI::App& benchmark, int& exit_code) {
  const auto [command, o] =
      AddStudy(benchmark, "alarm-kill",
               "kill -9 of a process that writes the alarm journal and feeds an MQTT broker: nothing is lost",
               RunAlarmKill, exit_code);
  command->add_option("--times", o->times, "Kills")->check(CLI::Range(1, 100000));
  command->add_option("--seed", o->seed, "Seed of times and alarms");
  command->footer(
      "Needs mosquitto, which scripts/setup.sh installs.\nExample:\n  hydroscope benchmark alarm-kill --times 200");
}

void AddBurstOptions(CLI::App* command, AlarmBurstOptions& o) {
  command->add_option("--alarms", o.alarms, "Alarms raised")->check(CLI::Range(20, 100000));
  command->add_option("--seconds", o.seconds, "s in which they are raised")->check(CLI::Range(0.1, 1e4));
}

void AddAlarmBurst(CLI::App& benchmark, int& exit_code) {
  const auto [command, o] =
      AddStudy(benchmark, "alarm-burst",
               "1000 alarms in a second: journal whole, feeds in order, a SCADA poller at 1 Hz misses none",
               RunAlarmBurst, exit_code);
  AddBurstOptions(command, *o);
  command->footer(
      "Needs mosquitto, which scripts/setup.sh installs.\nExample:\n  hydroscope benchmark alarm-burst");
}

/// The process the others start; not shown.
void AddAlarmLoad(CLI::App& benchmark, int& exit_code) {
  const auto [command, o] = AddStudy(benchmark, "alarm-load", "The process that the alarm campaigns watch",
                                     RunAlarmLoad, exit_code);
  command->group("");
  command->add_option("--db", o->database)->required();
  command->add_option("--broker", o->broker)->required();
  command->add_option("--mode", o->mode)->check(CLI::IsMember({"load", "burst", "drain"}));
  command->add_option("--seed", o->seed);
  command->add_option("--domain", o->domain)->check(CLI::Range(0, 232));
  AddBurstOptions(command, o->burst);
}

}  // namespace

void AddAlarmBenchmarks(CLI::App& benchmark, int& exit_code) {
  AddAlarmKill(benchmark, exit_code);
  AddAlarmBurst(benchmark, exit_code);
  AddAlarmLoad(benchmark, exit_code);
}

}  // namespace hydroscope
