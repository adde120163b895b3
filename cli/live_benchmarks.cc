// `hydroscope benchmark live-...`: campaigns of the live service.

#include "studies/live/live_benchmarks.h"

#include <CLI/CLI.hpp>

#include "cli/commands.h"
#include "cli/study_command.h"

namespace hydroscope {
namespace {

void AddLiveLatency(CLI::App& benchmark, int& exit_code) {
  const auto [command, o] = AddStudy(
      benchmark, "live-latency",
      "Service and simulated press as processes: latency, processor share, loss, live against replay",
      RunLiveLatency, exit_code);
  command->add_option("--axes", o->axes, "Axes of the press")->check(CLI::Range(1, 256));
  command->add_option("--rate", o->rate, "Samples per second, Hz")->check(CLI::Range(50.0, 1e4));
  command->add_option("--seconds", o->seconds, "s measured")->check(CLI::Range(5.0, 1e6));
  command->add_flag("--ring", o->ring, "All signals by the Modbus burst ring in place of DDS");
  command->add_option("--seed", o->seed, "Seed of the press");
  command
      ->add_option("--history", o->history,
                   "Strokes of each axis that the database holds already; 40 kB each")
      ->check(CLI::NonNegativeNumber);
  command
      ->add_option("--grams", o->grams,
                   "Newest of these that have their sums of products; older ones hold all else, 1 kB each")
      ->check(CLI::NonNegativeNumber);
  command->add_option("--folder", o->folder,
                      "Folder that is kept: the history is filled once, later runs begin on its database");
  command->footer(
      "Examples:\n"
      "  hydroscope benchmark live-latency\n"
      "  hydroscope benchmark live-latency --axes 64 --rate 500 --history 100000 --grams 2000");
}

void AddLiveKill(CLI::App& benchmark, int& exit_code) {
  const auto [command, o] =
      AddStudy(benchmark, "live-kill",
               "kill -9 of the service at random times under load: nothing acknowledged is lost", RunLiveKill,
               exit_code);
  command->add_option("--times", o->times, "Kills")->check(CLI::Range(1, 100000));
  command->add_option("--transport", o->transport, "Of DDS")->check(CLI::IsMember({"default", "udp", "shm"}));
  command->add_option("--seed", o->seed, "Seed of press and times");
  command->footer("Example:\n  hydroscope benchmark live-kill --times 200");
}

void AddLiveFaults(CLI::App& benchmark, int& exit_code) {
  const auto [command, o] = AddStudy(
      benchmark, "live-faults",
      "Senders killed, hung, talking nonsense, clocks stepped, disk full: told in time, back in time",
      RunLiveFaults, exit_code);
  command->add_flag("--long", o->long_cuts, "Also the silence of 60 s");
  command->add_flag("--brief", o->brief, "Only what takes seconds, and only what an operator sees");
  command->add_option("--seed", o->seed, "Seed of the press");
  command->footer("Example:\n  hydroscope benchmark live-faults --long");
}

void AddLiveSoak(CLI::App& benchmark, int& exit_code) {
  const auto [command, o] =
      AddStudy(benchmark, "live-soak", "Memory and descriptors of the service over time at full rates",
               RunLiveSoak, exit_code);
  command->add_option("--minutes", o->minutes, "Length")->check(CLI::Range(0.5, 1e5));
  command->add_option("--seed", o->seed, "Seed of the press");
  command->footer("Example:\n  hydroscope benchmark live-soak --minutes 30");
}

void AddLiveNetwork(CLI::App& benchmark, int& exit_code) {
  const auto [command, o] =
      AddStudy(benchmark, "live-network",
               "Press and service in networks of their own, and a wire between that loses, delays, is cut",
               RunLiveNetwork, exit_code);
  command->add_option("--cut", o->cut, "Length of the long cut, s")->check(CLI::Range(5.0, 3600.0));
  command->add_option("--seed", o->seed, "Seed of press and wire");
  command->footer(
      "Needs no rights where the kernel lets users make namespaces and /dev/net/tun is open to them, else root.\n"
      "Example:\n  hydroscope benchmark live-network");
}

}  // namespace

void AddLiveBenchmarks(CLI::App& benchmark, int& exit_code) {
  AddLiveLatency(benchmark, exit_code);
  AddLiveKill(benchmark, exit_code);
  AddLiveFaults(benchmark, exit_code);
  AddLiveNetwork(benchmark, exit_code);
  AddLiveSoak(benchmark, exit_code);
}

}  // namespace hydroscope
