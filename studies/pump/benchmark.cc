#include "studies/pump/benchmark.h"

#include <fmt/format.h>

#include <mutex>

#include "studies/effect_tally.h"
#include "studies/parallel.h"
#include "studies/pump/identification.h"
#include "studies/pump/machine.h"

namespace hydroscope {
namespace {

struct ExplainedPump {
  std::string hidden = "-";
  double size = 0, seconds = 0;
  StatesExplanation explanation;
};

ExplainedPump ExplainPump(std::uint64_t seed, std::size_t turn) {
  const auto& faults = AllPumpFaults();
  PumpOptions options = RandomPump(seed);
  ExplainedPump out;
  if (turn < faults.size()) {
    out.hidden = faults[turn].id;
    out.size = options.faults.*faults[turn].size = faults[turn].typical;
  }
  const Machine machine = PumpFile(true);
  const Episode episode = PumpEpisode(SimulatePump(options), machine);
  const double begin = ThreadSeconds();
  out.explanation = ExplainStates(machine, std::span(&episode, 1));
  out.seconds = ThreadSeconds() - begin;
  return out;
}

/// Hides each effect in logs of random pumps, and nothing in as many, and prints what `explain` says. True if nothing is named
/// wrongly and 95 % of the effects are named first.
bool PrintPumpEffects(const PumpBenchmarkOptions& o) {
  const std::size_t turns = AllPumpFaults().size() + 1;
  EffectTally tally;
  std::mutex mutex;
  ProgressBar progress("effects", "logs");
  fmt::print("\n");
  ForEachCase(
      static_cast<int>(turns) * o.effects, progress,
      [&](int number) {
        const std::uint64_t seed = o.seed * 1000 + number;
        const ExplainedPump pump = ExplainPump(seed, number % turns);
        const std::lock_guard lock(mutex);
        fmt::print("{:>5} {}, {:.1f} s\n", seed, tally.Add(pump.hidden, pump.size, pump.explanation),
                   pump.seconds);
        std::fflush(stdout);
      },
      o.threads);
  fmt::print("{}", tally.Table());
  return tally.Reached();
}

}  // namespace

int RunPumpBenchmark(const PumpBenchmarkOptions& options) {
  bool reached = PrintPumpIdentification(options);
  if (options.effects > 0) reached = PrintPumpEffects(options) && reached;
  fmt::print("{}\n", reached ? "all goals reached" : "NOT all goals reached");
  return reached ? 0 : 1;
}

}  // namespace hydroscope
