#include "studies/pump/effects.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <mutex>

#include "diagnosis/states/explain_states.h"
#include "studies/parallel.h"
#include "studies/pump/machine.h"

namespace hydroscope {
namespace {

struct PumpVerdict {
  bool hidden = false, first = false, ambiguous = false, wrong = false, adequate = false;
  std::string line;
};

PumpVerdict ExplainPump(std::uint64_t seed, std::size_t turn) {
  const auto& faults = AllPumpFaults();
  PumpOptions options = RandomPump(seed);
  const std::string hidden = turn < faults.size() ? faults[turn].id : "";
  if (!hidden.empty()) options.faults.*faults[turn].size = faults[turn].typical;
  const Machine machine = PumpFile(true);
  const Episode episode = PumpEpisode(SimulatePump(options), machine);
  const double begin = ThreadSeconds();
  const StatesExplanation x = ExplainStates(machine, std::span(&episode, 1));
  PumpVerdict out;
  out.hidden = !hidden.empty();
  const bool in_set = std::find(x.set.begin(), x.set.end(), hidden) != x.set.end();
  out.first = out.hidden && !x.set.empty() && x.set.front() == hidden;
  out.ambiguous = in_set && x.verdict == Verdict::kAmbiguous;
  out.wrong = !x.set.empty() && !in_set;
  out.adequate = x.verdict == Verdict::kAdequate;
  out.line =
      fmt::format("{:>5} hidden {:<16} {:<9} [{}]{} left {:.3f} -> {:.3f}, {:.1f} s{}\n", seed,
                  hidden.empty() ? "-" : hidden, VerdictName(x.verdict), fmt::join(x.set, ", "),
                  x.nearest.empty() ? "" : fmt::format(" part {}", fmt::join(x.nearest, ", ")),
                  x.base_left.share, x.final_left.share, ThreadSeconds() - begin, out.wrong ? " WRONG" : "");
  return out;
}

}  // namespace

bool PrintPumpEffects(const PumpBenchmarkOptions& o) {
  const std::size_t turns = AllPumpFaults().size() + 1;
  std::vector<PumpVerdict> verdicts(turns * static_cast<std::size_t>(o.effects));
  std::mutex mutex;
  ProgressBar progress("effects", "logs");
  fmt::print("\n");
  ForEachCase(
      static_cast<int>(verdicts.size()), progress,
      [&](int number) {
        const auto at = static_cast<std::size_t>(number);
        verdicts[at] = ExplainPump(o.seed * 1000 + at, at % turns);
        const std::lock_guard lock(mutex);
        fmt::print("{}", verdicts[at].line);
        std::fflush(stdout);
      },
      o.threads);
  const auto count = [&](auto what) {
    return static_cast<int>(std::count_if(verdicts.begin(), verdicts.end(), what));
  };
  const int hidden = count([](const PumpVerdict&v) { return v.hidden; }),
            first = count([](const PumpVerdict&v) { return v.first; }),
            ambiguous = count([](const PumpVerdict&v) { return v.ambiguous; }),
            wrong = count([](const PumpVerdict&v) { return v.wrong; }),
            adequate = count([](const PumpVerdict&v) { return !v.hidden && v.adequate; });
  const int healthy = static_cast<int>(verdicts.size()) - hidden;
  fmt::print(
      "\neffect named first {} of {} ({} of them with others beside it), healthy adequate {} of {}, wrong {} of {}\n",
      first, hidden, ambiguous, adequate, healthy, wrong, verdicts.size());
  return first >= 0.95 * hidden && wrong <= 0.01 * static_cast<double>(verdicts.size());
}

}  // namespace hydroscope
