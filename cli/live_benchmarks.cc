// `hydroscope benchmark live-...`: campaigns of the live service.

#include "studies/live/live_benchmarks.h"

#include <CLI/CLI.hpp>
#include <memory>

#include "cli/commands.h"

namespace hydroscope {
namespace {

void AddLiveLatency(CLI::App& benchmark, int& exit_code) {
  auto o = std::make_shared<LiveLatencyOptions>();
  CLI::App* command = benchmark.add_subcommand(
      "live-latency",
      "Service and simulated press as processes: latency, processor share, loss, live against replay");
  command->add_option("--axes", o->axes, "Axes of the press")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  command->add_option("--rate", o->rate, "Samples per second, Hz")
      ->check(CLI::Range(50.0, 1e4))
      ->capture_default_str();
  command->add_option("--seconds", o->seconds, "s measured")
      ->check(CLI::Range(5.0, 1e6))
      ->capture_default_str();
  command->add_flag("--ring", o->ring, "All signals by the Modbus burst ring in place of DDS");
  command->add_option("--seed", o->seed, "Seed of the press")->capture_default_str();
  command
      ->add_option("--history", o->history,
                   "Strokes of each axis that the database holds already; 40 kB each")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command->footer(
      "Examples:\n"
      "  hydroscope benchmark live-latency\n"
      "  hydroscope benchmark live-latency --axes 64 --rate 500");
  command->callback([o, &exit_code] { exit_code = RunLiveLatency(*o); });
}

void AddLiveKill(CLI::App& benchmark, int& exit_code) {
  auto o = std::make_shared<LiveKillOptions>();
  CLI::App* command = benchmark.add_subcommand(
      "live-kill", "kill -9 of the service at random times under load: nothing acknowledged is lost");
  command->add_option("--times", o->times, "Kills")->check(CLI::Range(1, 100000))->capture_default_str();
  command->add_option("--transport", o->transport, "Of DDS")
      ->check(CLI::IsMember({"default", "udp", "shm"}))
      ->capture_default_str();
  command->add_option("--seed", o->seed, "Seed of press and times")->capture_default_str();
  command->footer("Example:\n  hydroscope benchmark live-kill --times 200");
  command->callback([o, &exit_code] { exit_code = RunLiveKill(*o); });
}

void AddLiveFaults(CLI::App& benchmark, int& exit_code) {
  auto o = std::make_shared<LiveFaultOptions>();
  CLI::App* command = benchmark.add_subcommand(
      "live-faults",
      "Senders killed, hung, talking nonsense, clocks stepped, disk full: told in time, back in time");
  command->add_flag("--long", o->long_cuts, "Also the silence of 60 s");
  command->add_flag("--brief", o->brief, "Only what takes seconds, and only what an operator sees");
  command->add_option("--seed", o->seed, "Seed of the press")->capture_default_str();
  command->footer("Example:\n  hydroscope benchmark live-faults --long");
  command->callback([o, &exit_code] { exit_code = RunLiveFaults(*o); });
}

void AddLiveSoak(CLI::App& benchmark, int& exit_code) {
  auto o = std::make_shared<LiveSoakOptions>();
  CLI::App* command =
      benchmark.add_subcommand("live-soak", "Memory and descriptors of the service over time at full rates");
  command->add_option("--minutes", o->minutes, "Length")->check(CLI::Range(0.5, 1e5))->capture_default_str();
  command->add_option("--seed", o->seed, "Seed of the press")->capture_default_str();
  command->footer("Example:\n  hydroscope benchmark live-soak --minutes 30");
  command->callback([o, &exit_code] { exit_code = RunLiveSoak(*o); });
}

void AddLiveNetwork(CLI::App& benchmark, int& exit_code) {
  auto o = std::make_shared<LiveNetworkOptions>();
  CLI::App* command = benchmark.add_subcommand(
      "live-network",
      "Press and service in networks of their own, and a wire between that loses, delays, is cut");
  command->add_option("--cut", o->cut, "Length of the long cut, s")
      ->check(CLI::Range(5.0, 3600.0))
      ->capture_default_str();
  command->add_option("--seed", o->seed, "Seed of press and wire")->capture_default_str();
  command->footer(
      "Needs no rights where the kernel lets users make namespaces and /dev/net/tun is open to them, else "
      "root.\n"
      "Example:\n  hydroscope benchmark live-network");
  command->callback([o, &exit_code] { exit_code = RunLiveNetwork(*o); });
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
